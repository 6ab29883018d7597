"""Ellipse: a pymunk shape whose hull stands for it in the broad phase."""

from __future__ import annotations

import weakref
from math import cos, isclose, pi, sin
from typing import Any, ClassVar, NoReturn

import pymunk
from pymunk import (
    BB,
    ContactPoint,
    ContactPointSet,
    PointQueryInfo,
    SegmentQueryInfo,
    Vec2d,
)

from . import _checks, contacts
from ._layout import unproved, write_ellipse
from ._pymunk import NO_SPACE
from .geometry import IDENTITY, Transform, body_transform
from .hull import Hull, hull_with_moment, rounded_hull
from .narrowphase.placement import Frame, placed
from .narrowphase.query import half_extents, nearest_point, segment_hit, settled
from .queries import touched_corner, transform_now
from .resolver import contact_with_ellipse, contact_with_shape


class Ellipse(pymunk.Poly):
    """An ellipse with the semi-axes a and b.

    It is used like pymunk's own shapes. Contacts with ellipses, circles, segments and convex
    polygons are exact from the moment it is added to any :py:class:`pymunk.Space`.

    pymunk sees a polygon with rounded corners that contains the ellipse:
    :py:meth:`get_vertices`, :py:attr:`radius` and what a plain :py:class:`pymunk.Space` finds
    in its queries are those of this hull. Mass, moment of inertia, area, bounding box and the
    shape's own queries are those of the ellipse, and in a :py:class:`pymunk_ellipse.Space` so
    are all.

    The distance to a shape and the normal are found by fitting circles to the ellipses, after
    N. Hori, "Collision of Ellipses", at a common normal.

    >>> space = pymunk.Space()
    >>> body = pymunk.Body()
    >>> egg = Ellipse(body, 20, 10)
    >>> egg.density = 0.01
    >>> space.add(body, egg)
    >>> round(body.mass, 3), round(body.moment, 1)
    (6.283, 785.4)
    """

    # Where an ellipse without a body is.
    _updated: Transform = IDENTITY

    _pickle_attrs_init: ClassVar[list[str]] = [
        *pymunk.Shape._pickle_attrs_init,
        "a",
        "b",
        "offset",
        "angle",
    ]

    def __init__(
        self,
        body: pymunk.Body | None,
        a: float,
        b: float,
        offset: tuple[float, float] = (0, 0),
        angle: float = 0.0,
    ) -> None:
        """Create an ellipse.

        body is the body to attach it to; as for pymunk's shapes it may be None until the
        ellipse is added to a space. a and b are the semi-axes; either may be the longer.
        offset is the centre, from the body's origin, and angle the angle of a (radians), both
        in body local coordinates.

        Raises TypeError for arguments that are not numbers, and ValueError for numbers that
        are not finite, for semi-axes that are not positive, and for those outside 1e-50 to
        1e50 or with a ratio beyond 1e6.
        """
        self._set_frame(a, b, offset, angle)
        vertices, radius = self._hull()
        # Chipmunk takes mass properties from vertices and radius now, and does not when the
        # radius changes: those of the vertices alone stay.
        super().__init__(body, vertices)
        super().unsafe_set_radius(radius)
        self._write()

    def _hull(self) -> Hull:
        make = rounded_hull if unproved() is None else hull_with_moment
        return make(self._a, self._b, self._angle, *self._offset)

    def _write(self) -> None:
        if unproved() is None:
            write_ellipse(self._shape, self._frame)

    def _set_frame(self, a: Any, b: Any, offset: Any, angle: Any) -> None:
        self._a, self._b = _checks.semi_axes(a, b)
        self._offset = _checks.offset(offset, self._a, self._b)
        self._angle = _checks.number("angle", angle)
        longer = self._angle if self._a >= self._b else self._angle + pi / 2.0
        self._frame: Frame = (
            max(self._a, self._b),
            min(self._a, self._b),
            cos(longer),
            sin(longer),
            self._offset.x,
            self._offset.y,
        )

    @property
    def a(self) -> float:
        """The semi-axis at :py:attr:`angle`."""
        return self._a

    @property
    def b(self) -> float:
        """The semi-axis perpendicular to a."""
        return self._b

    @property
    def offset(self) -> Vec2d:
        """The centre, in body local coordinates."""
        return self._offset

    @property
    def angle(self) -> float:
        """The angle of a (radians), in body local coordinates."""
        return self._angle

    @property
    def area(self) -> float:
        """The area, pi a b."""
        return pi * self._a * self._b

    @property
    def density(self) -> float:
        """Mass per area; setting it sets :py:attr:`mass`."""
        return self.mass / self.area

    @density.setter
    def density(self, density: float) -> None:
        self.mass = density * self.area

    def unsafe_set_semi_axes(self, a: float, b: float) -> None:
        """Set the semi-axes.

        .. note::
            As with the other unsafe setters of pymunk, the change is picked up as a change of
            the surface's position, not of its velocity.

        Raises what the constructor raises.
        """
        self._reshape(a, b, self._offset, self._angle)

    def unsafe_set_offset(self, offset: tuple[float, float]) -> None:
        """Set the centre, in body local coordinates; see unsafe_set_semi_axes."""
        self._reshape(self._a, self._b, offset, self._angle)

    def unsafe_set_angle(self, angle: float) -> None:
        """Set the angle of a, in body local coordinates; see unsafe_set_semi_axes."""
        self._reshape(self._a, self._b, self._offset, angle)

    def _reshape(self, a: Any, b: Any, offset: Any, angle: Any) -> None:
        self._set_frame(a, b, offset, angle)
        vertices, radius = self._hull()
        super().unsafe_set_vertices(vertices)
        super().unsafe_set_radius(radius)
        self._write()
        if self.mass > 0.0:
            # Once more, for the body to take over the new moment.
            self.mass = self.mass
        if self.space is not None:
            contacts.enter(self.space, self._shape, self._frame)

    def unsafe_set_vertices(self, *args: Any, **kwargs: Any) -> NoReturn:
        """The hull follows from the semi-axes: raises TypeError."""
        raise TypeError("an Ellipse has no vertices to set, use unsafe_set_semi_axes")

    def unsafe_set_radius(self, *args: Any, **kwargs: Any) -> NoReturn:
        """The hull follows from the semi-axes: raises TypeError."""
        raise TypeError("an Ellipse has no radius to set, use unsafe_set_semi_axes")

    def update(self, transform: pymunk.Transform) -> BB:
        """Update, cache and return the bounding box, with an explicit transform.

        For an ellipse without a body, that is also where shapes_collide takes it to be.

        Raises ValueError for a transform that is not a rotation and a translation.
        """
        rigid = (
            isclose(transform.a, transform.d, abs_tol=1e-9)
            and isclose(transform.b, -transform.c, abs_tol=1e-9)
            and isclose(transform.a**2 + transform.b**2, 1.0, abs_tol=1e-9)
        )
        if not rigid:
            raise ValueError(
                f"transform must be a rotation and a translation, got {transform}"
            )
        self._updated = (
            transform.tx,
            transform.ty,
            transform.a,
            transform.b,
        )
        super().update(transform)
        return self.bb

    def cache_bb(self) -> BB:
        """Take over the body's position in pymunk, and return the bounding box."""
        super().cache_bb()
        return self.bb

    @property
    def bb(self) -> BB:
        """The bounding box of the ellipse, where its body is now; without a body, where update put it.

        >>> Ellipse(None, 2, 1, offset=(10, 0)).bb
        BB(left=8.0, bottom=-1.0, right=12.0, top=1.0)
        """
        ellipse = self._placed()
        width, height = half_extents(ellipse)
        x, y = ellipse[4:]
        return BB(x - width, y - height, x + width, y + height)

    def point_query(self, p: tuple[float, float]) -> PointQueryInfo:
        """The nearest point of the surface to p, with the distance and its gradient, all in world coordinates.

        Inside the ellipse the distance is negative. The gradient is the outward unit normal at
        the nearest point; it is finite everywhere, and where several points are nearest, as at
        the centre, it is that of one of them.

        The ellipse is taken where its body is now; without a body, where update put it.

        Raises TypeError or ValueError for a point that is not two finite numbers.

        >>> hit = Ellipse(None, 2, 1).point_query((0, 4))
        >>> hit.point, hit.distance, hit.gradient
        (Vec2d(0.0, 1.0), 3.0, Vec2d(0.0, 1.0))
        """
        return self._nearest(_checks.point("p", p))

    def _nearest(self, p: Vec2d) -> PointQueryInfo:
        distance, nx, ny, px, py = nearest_point(self._placed(), p.x, p.y)
        return PointQueryInfo(self, Vec2d(px, py), distance, Vec2d(nx, ny))

    def segment_query(
        self, start: tuple[float, float], end: tuple[float, float], radius: float = 0
    ) -> SegmentQueryInfo | None:
        """Where a circle of the given radius first touches the ellipse on its straight way from start to end.

        Returns None if it does not. alpha is the part of the way before the touch (0 to 1),
        point the point of the ellipse that is touched and normal the outward normal there, in
        world coordinates.

        If the two touch at the start already, alpha is zero, point is the end, and normal leads
        from the nearest point of the surface to the start, as for all of pymunk's shapes.

        The ellipse is taken where its body is now; without a body, where update put it.

        Raises TypeError or ValueError for points that are not two finite numbers and for a
        radius that is not one.

        >>> hit = Ellipse(None, 2, 1).segment_query((0, 8), (0, -2), radius=2)
        >>> hit.point, hit.normal, hit.alpha
        (Vec2d(0.0, 1.0), Vec2d(0.0, 1.0), 0.5)
        """
        return self._hit(
            _checks.point("start", start),
            _checks.point("end", end),
            _checks.number("radius", radius),
        )

    def _hit(self, start: Vec2d, end: Vec2d, radius: float) -> SegmentQueryInfo | None:
        hit = segment_hit(self._placed(), start.x, start.y, end.x, end.y, radius)
        if hit is None:
            return None
        alpha, nx, ny, px, py = hit
        return SegmentQueryInfo(self, Vec2d(px, py), Vec2d(nx, ny), alpha)

    def _placed(self) -> Frame:
        transform = body_transform(self)
        return placed(self._frame, *(transform or self._updated))

    def shapes_collide(self, b: pymunk.Shape) -> ContactPointSet:
        """Get contact information about this ellipse and shape b.

        The set has the normal from the ellipse to b and one point, with points on the two
        surfaces in world coordinates and the distance, negative when they overlap. If they do
        not touch it has no points, and a zero normal.

        Both are taken where their bodies are now; without a body, where update put them.

        >>> left = Ellipse(pymunk.Body(), 2, 1)
        >>> right = pymunk.Circle(pymunk.Body(), 1, offset=(2.5, 0))
        >>> contact = left.shapes_collide(right)
        >>> contact.normal, contact.points[0].distance
        (Vec2d(1.0, 0.0), -0.5)
        """
        ellipse = self._placed()
        if isinstance(b, Ellipse):
            contact = contact_with_ellipse(ellipse, b._placed(), 0.0, 0.0, 0.0)
        elif isinstance(b, pymunk.Shape):
            contact = contact_with_shape(ellipse, b, transform_now(b), 0.0, 0.0, 0.0)
        else:
            raise TypeError(f"b must be a pymunk.Shape, got {b!r}")
        if contact[0] > 0.0:
            return ContactPointSet(Vec2d.zero(), ())
        if isinstance(b, Ellipse):
            touched: Frame | None = b._placed()
        else:
            touched = touched_corner(ellipse, b, contact)
        if touched is not None:
            contact = settled(ellipse, touched, contact)
        distance, nx, ny, px, py, _evaluations = contact
        normal = Vec2d(nx, ny)
        on_ellipse = Vec2d(ellipse[4] + px, ellipse[5] + py)
        point = ContactPoint(on_ellipse, on_ellipse + distance * normal, distance)
        return ContactPointSet(normal, (point,))

    # pymunk tells a shape that it enters or leaves a space by setting this.
    @property
    def _space(self) -> weakref.ref[pymunk.Space]:
        reference: weakref.ref[pymunk.Space] = self.__dict__.get("_in_space", NO_SPACE)
        return reference

    @_space.setter
    def _space(self, reference: weakref.ref[pymunk.Space]) -> None:
        old = self._space()
        if old is not None:
            contacts.leave(old, self._shape)
        self.__dict__["_in_space"] = reference
        new = reference()
        if new is not None:
            contacts.enter(new, self._shape, self._frame)

    def __getstate__(self) -> dict[str, list[tuple[str, Any]]]:
        """The state to copy and pickle: the constructor's arguments and the attributes of every shape."""
        state = super(pymunk.Poly, self).__getstate__()
        state["general"] = [(k, v) for k, v in state["general"] if k != "density"]
        return state
