"""Ellipse: a pymunk shape whose hull stands for it in the broad phase."""

from __future__ import annotations

import weakref
from math import isclose, pi
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, NoReturn

import pymunk
from pymunk import (
    BB,
    ContactPoint,
    ContactPointSet,
    PointQueryInfo,
    SegmentQueryInfo,
    Vec2d,
)

from . import _checks, hull
from .chipmunk.private import NO_SPACE, c_points, new_polygon, set_polygon
from .chipmunk.shape_class import frame_now
from .chipmunk.structs import INLINE_VERTICES, ellipse_class, hull_at, shape_at
from .contacts import handler
from .contacts.backend import kernel
from .narrowphase.frame import Frame, frame_of, half_extents
from .outline import outline_vertices

if TYPE_CHECKING:
    from .contacts.pair import ShapeContact


# Of an ellipse that has touched nothing: long before a space's first step.
NO_STEP = -2


class ShapeDistance(NamedTuple):
    """How far two shapes are apart, and where; see :py:meth:`Ellipse.distance`."""

    #: The distance of the surfaces, negative where the shapes overlap: minus the least
    #: translation that parts them.
    distance: float
    #: The unit normal from the first shape to the second.
    normal: Vec2d
    #: The point of the first shape that is nearest to the second or, where they overlap, deepest in it.
    point_a: Vec2d
    #: The same of the second shape, at the distance along the normal from point_a.
    point_b: Vec2d


class Ellipse(pymunk.Poly):
    """An ellipse with the semi-axes a and b.

    It is used like pymunk's own shapes. Contacts with ellipses, circles, segments and convex
    polygons are exact from the moment it is added to any :py:class:`pymunk.Space`.

    pymunk sees a polygon with rounded corners that contains the ellipse: :py:meth:`get_vertices`
    and :py:attr:`radius` are those of this hull. Mass, moment of inertia, area, bounding box and
    queries are those of the ellipse, and in a :py:class:`pymunk_ellipse.Space` so is all else.
    In a plain :py:class:`pymunk.Space`, drawing, sensors, ``shape_query`` and the callbacks
    ``begin`` and ``separate`` go by the hull. There ``pre_solve`` for collision types is called
    before the exact contact is known, and what it writes into normal and points is lost; that
    for all collisions, ``on_collision(None, None, ...)``, and ``post_solve`` are called after.

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

    # What makes the hull: a polygon around the unit circle, and how much of b its corners' radius is.
    _unit_polygon: Any = c_points(hull.unit_polygon(hull.VERTICES))
    _rounding: float = hull.ROUNDING

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
        kernel()
        new_polygon(
            self, body, self._unit_polygon, *hull.stretch(self._frame, self._rounding)
        )
        self._become_ellipse()

    def _become_ellipse(self) -> None:
        """Make the hull an ellipse: its class, its frames and its mass properties, which Chipmunk took from the vertices."""
        cp_hull = hull_at(self._shape)
        if cp_hull.count <= INLINE_VERTICES:
            # Roundoff has made vertices one: the frames have no room.
            raise ValueError(
                f"offset must not be so far that roundoff hides the ellipse, got {self._offset!r}"
            )
        a, b, _c, _s, x, y = frame = self._frame
        cp_hull.local = frame
        cp_hull.world = frame
        shape = cp_hull.shape
        shape.i = (a * a + b * b) / 4.0
        shape.cog.x = x
        shape.cog.y = y
        shape.area = pi * a * b
        self._polygon_class = shape.klass
        shape.klass = ellipse_class()

    def _set_frame(self, a: Any, b: Any, offset: Any, angle: Any) -> None:
        self._a, self._b = _checks.semi_axes(a, b)
        self._offset = _checks.offset(offset, self._a, self._b)
        self._angle = _checks.number("angle", angle)
        self._frame: Frame = frame_of(self._a, self._b, *self._offset, self._angle)

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
        """Mass per area; setting it sets the mass."""
        return self.mass / self.area

    @density.setter
    def density(self, density: float) -> None:
        self.mass = density * self.area

    def unsafe_set_semi_axes(self, a: float, b: float) -> None:
        """Set the semi-axes.

        .. note::
            As with the other unsafe setters of pymunk, the change is picked up as a change of
            the surface's position, not of its velocity. Without a body the ellipse is then
            where it was before any update.

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
        at = _last_update(self)
        # Chipmunk sets the vertices of what has the class of polygons, and nothing else's.
        shape_at(self._shape).klass = self._polygon_class
        set_polygon(
            self, self._unit_polygon, *hull.stretch(self._frame, self._rounding)
        )
        self._become_ellipse()
        if self.body is None:
            # What was placed in the world has gone with the old vertices.
            super().update(at)
        else:
            if self.mass > 0.0:
                # Once more, for the body to take over the new moment.
                self.mass = self.mass
            # A step may be on its way, which has placed its shapes already.
            self.cache_bb()

    @property
    def radius(self) -> float:
        """The radius of the hull that pymunk's broad phase sees."""
        radius: float = hull_at(self._shape).r
        return radius

    def get_vertices(self) -> list[Vec2d]:
        """The vertices of the hull that pymunk's broad phase sees, in body local coordinates."""
        cp_hull = hull_at(self._shape)
        planes = cp_hull.planes
        count = cp_hull.count
        return [
            Vec2d(planes[4 * i], planes[4 * i + 1]) for i in range(count, 2 * count)
        ]

    def unsafe_set_vertices(self, *args: Any, **kwargs: Any) -> NoReturn:
        """The hull follows from the semi-axes: raises TypeError."""
        raise TypeError("an Ellipse has no vertices to set, use unsafe_set_semi_axes")

    def unsafe_set_radius(self, *args: Any, **kwargs: Any) -> NoReturn:
        """The hull follows from the semi-axes: raises TypeError."""
        raise TypeError("an Ellipse has no radius to set, use unsafe_set_semi_axes")

    def update(self, transform: pymunk.Transform) -> BB:
        """Update, cache and return the bounding box, with an explicit transform.

        For an ellipse without a body, that is also where shapes_collide takes it to be.

        Raises TypeError for what is no pymunk.Transform, and ValueError for one that is not a
        rotation and a finite translation.
        """
        if not isinstance(transform, pymunk.Transform):
            raise TypeError(f"transform must be a pymunk.Transform, got {transform!r}")
        for name, value in zip(("tx", "ty"), transform[4:], strict=True):
            _checks.number(f"transform.{name}", value)
        rigid = (
            isclose(transform.a, transform.d, abs_tol=1e-9)
            and isclose(transform.b, -transform.c, abs_tol=1e-9)
            and isclose(transform.a**2 + transform.b**2, 1.0, abs_tol=1e-9)
        )
        if not rigid:
            raise ValueError(
                f"transform must be a rotation and a translation, got {transform}"
            )
        return super().update(transform)

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

    def outline(self, transform: pymunk.Transform | None = None) -> list[Vec2d]:
        """Vertices of a polygon that looks like the ellipse, to draw it by hand.

        Without a transform they are world coordinates, where the body is now; without a body,
        where update put it. A transform leads from body local coordinates to wherever the
        ellipse is drawn: the identity gives local points for a sprite, one with a camera's
        scale as many vertices as the screen can show.

        The vertices lie on the ellipse, counterclockwise before the transform, the first one at
        the end of the semi-axis a. The ellipse is nowhere farther from an edge than a tenth of
        a unit of where the transform leads, a pixel say, or than a thousandth of its longer
        semi-axis, whichever is less, as long as 1000 vertices suffice.
        :py:meth:`pymunk_ellipse.Space.debug_draw` draws with the same vertices.

        >>> body = pymunk.Body()
        >>> body.position = 100, 50
        >>> egg = Ellipse(body, 20, 10)
        >>> world = egg.outline()
        >>> world[0], len(world)
        (Vec2d(120.0, 50.0), 71)
        >>> egg.outline(pymunk.Transform.scaling(2))[0]
        Vec2d(40.0, 0.0)
        """
        if transform is None:
            frame, transform = self._placed(), pymunk.Transform.identity()
        else:
            frame = self._frame
        return outline_vertices(frame, self._a >= self._b, transform)

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
        point = _checks.point("p", p)
        with _Orphans(self):
            distance, nx, ny, px, py = kernel().nearest_now(
                self._shape, point.x, point.y
            )
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
        start = _checks.point("start", start)
        end = _checks.point("end", end)
        radius = _checks.number("radius", radius)
        with _Orphans(self):
            alpha, nx, ny, px, py = kernel().cast_now(
                self._shape, start.x, start.y, end.x, end.y, radius
            )
        if alpha > 1.0:
            return None
        return SegmentQueryInfo(self, Vec2d(px, py), Vec2d(nx, ny), alpha)

    def _placed(self) -> Frame:
        with _Orphans(self):
            return frame_now(hull_at(self._shape))

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
        distance, nx, ny, ax, ay, bx, by = self._contact("b", b)
        if distance > 0.0:
            return ContactPointSet(Vec2d.zero(), ())
        point = ContactPoint(Vec2d(ax, ay), Vec2d(bx, by), distance)
        return ContactPointSet(Vec2d(nx, ny), (point,))

    def distance(self, other: pymunk.Shape) -> ShapeDistance:
        """The distance to another shape, the normal towards it and the nearest points, exact apart and overlapping.

        other is any of pymunk's shapes. The distance is negative where the two overlap; then it
        is minus the least translation that parts them. All is in world coordinates.

        Both are taken where their bodies are now; without a body, where update put them.

        Raises TypeError if other is not a pymunk.Shape.

        >>> left = Ellipse(pymunk.Body(), 2, 1)
        >>> right = pymunk.Circle(pymunk.Body(), 1, offset=(5, 0))
        >>> left.distance(right)
        ShapeDistance(distance=2.0, normal=Vec2d(1.0, 0.0), point_a=Vec2d(2.0, 0.0), point_b=Vec2d(4.0, 0.0))
        """
        distance, nx, ny, ax, ay, bx, by = self._contact("other", other)
        return ShapeDistance(distance, Vec2d(nx, ny), Vec2d(ax, ay), Vec2d(bx, by))

    def _contact(self, name: str, other: Any) -> ShapeContact:
        if not isinstance(other, pymunk.Shape):
            raise TypeError(f"{name} must be a pymunk.Shape, got {other!r}")
        with _Orphans(self, other):
            return kernel().shape_contact(self._shape, other._shape)

    # pymunk tells a shape that it enters or leaves a space by setting this.
    @property
    def _space(self) -> weakref.ref[pymunk.Space]:
        reference: weakref.ref[pymunk.Space] = self.__dict__.get("_in_space", NO_SPACE)
        return reference

    @_space.setter
    def _space(self, reference: weakref.ref[pymunk.Space]) -> None:
        old = self._space()
        if old is not None:
            handler.leave(old)
        self.__dict__["_in_space"] = reference
        new = reference()
        if new is not None:
            # They are of another space.
            cp_hull = hull_at(self._shape)
            cp_hull.touches = [0] * 16
            cp_hull.touched_in = NO_STEP
            handler.enter(new)

    def __getstate__(self) -> dict[str, list[tuple[str, Any]]]:
        """The state to copy and pickle: the constructor's arguments and the attributes of every shape."""
        state = super(pymunk.Poly, self).__getstate__()
        state["general"] = [(k, v) for k, v in state["general"] if k != "density"]
        return state


class _Orphans:
    """Has C shapes whose body is gone point to none for a while: a shape does not keep its body alive.

    Not for good, because by that pointer Chipmunk takes a shape out of its space.
    """

    __slots__ = ("_bodies",)

    def __init__(self, *shapes: pymunk.Shape) -> None:
        self._bodies: list[tuple[Any, int]] = []
        for shape in shapes:
            if shape.body is None:
                cp_shape = shape_at(shape._shape)
                self._bodies.append((cp_shape, cp_shape.on_body))

    def __enter__(self) -> None:
        for cp_shape, _body in self._bodies:
            cp_shape.on_body = 0

    def __exit__(self, *error: object) -> None:
        for cp_shape, body in self._bodies:
            cp_shape.on_body = body


def _last_update(ellipse: Ellipse) -> pymunk.Transform:
    """The transform with which an ellipse was updated last; the identity before the first time."""
    cp_hull = hull_at(ellipse._shape)
    _a, _b, c, s, x, y = cp_hull.local
    _a, _b, world_c, world_s, world_x, world_y = cp_hull.world
    cos = c * world_c + s * world_s
    sin = c * world_s - s * world_c
    return pymunk.Transform(
        cos, sin, -sin, cos, world_x - cos * x + sin * y, world_y - sin * x - cos * y
    )
