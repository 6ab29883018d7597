"""Space: a pymunk.Space in which callbacks, queries and drawing see the ellipses, not their hulls."""

from __future__ import annotations

from typing import Any, ClassVar, cast

from pymunk import (
    BB,
    ContactPoint,
    ContactPointSet,
    PointQueryInfo,
    SegmentQueryInfo,
    Shape,
    ShapeFilter,
    ShapeQueryInfo,
    SpaceDebugDrawOptions,
    Vec2d,
)

from . import _checks
from .chipmunk.private import shape_at_address
from .chipmunk.structs import address
from .contacts.events import EventSpace
from .contacts.handler import ellipses_in
from .contacts.saved import bias_velocities, set_bias_velocities
from .drawing import TrueOutlines
from .ellipse import Ellipse
from .wide_rays import overlooked_ellipses


class Space(EventSpace):
    """A :py:class:`pymunk.Space` in which everything to be observed is the ellipse.

    In a plain pymunk.Space contacts and queries of ellipses are exact as well, but callbacks,
    :py:meth:`shape_query` and drawing see their hulls. Here callbacks are called when ellipses
    touch, :py:meth:`debug_draw` draws their outlines, and :py:meth:`segment_query` with a radius
    overlooks none. It is used like pymunk's own. Whatever has no ellipse in it is as in pymunk.

    As in pymunk, queries of the space see shapes where the last step, or the last
    :py:meth:`pymunk.Space.reindex_shapes_for_body`, left them.

    While there are ellipses in the space, the queries raise TypeError for arguments that are
    not numbers, and ValueError for those that are not finite (a bounding box and a maximal
    distance may be infinite).

    >>> import pymunk
    >>> space = Space()
    >>> egg = Ellipse(space.static_body, 20, 10)
    >>> space.add(egg)
    >>> space.point_query_nearest((30, 0), 50, pymunk.ShapeFilter()).distance
    10.0
    """

    _pickle_attrs_general: ClassVar[list[str]] = [
        *EventSpace._pickle_attrs_general,
        "exact_impacts",
    ]

    def __init__(self, threaded: bool = False, *, exact_impacts: bool = False) -> None:
        """A space without shapes; threaded is that of :py:class:`pymunk.Space`.

        exact_impacts is explained at the attribute of this name.

        Raises TypeError if exact_impacts is not a bool.
        """
        super().__init__(threaded)
        self.exact_impacts = exact_impacts

    @property
    def exact_impacts(self) -> bool:
        """Whether shapes that meet within a step collide where and when they met (False).

        pymunk moves bodies by whole steps. Shapes that met on the way collide where the step has
        left them, overlapped. So the outcome is off in proportion to the step. With this switched
        on, a new contact that comes in fast has the normal and the points of the moment of the
        impact, and the bodies are moved on as the impact would have moved them since. Bounces,
        landings and collisions are then off in proportion to the square of the step. It changes
        only contacts of ellipses, and none that last.

        These contacts stay as they are without it:

        - those of an ellipse that has touched something else in this step or the last one,
        - those of a body that has a joint, or a velocity or position function of its own,
        - those of sensors,
        - those of ellipses that are round about their centre of gravity, with each other and with
          pymunk's own shapes.

        Two bodies that hit each other are moved on only so far that neither goes more than three
        quarters of half its thickness in a step. So none passes through a wall behind it. In such
        a collision the distance of the two contact points is no depth: each is the point of the
        impact, moved with its body since.

        >>> import pymunk
        >>> heights = []
        >>> for exact in (False, True):
        ...     space = Space(exact_impacts=exact)
        ...     floor = pymunk.Segment(space.static_body, (-99, 0), (99, 0), 0)
        ...     egg = Ellipse(pymunk.Body(mass=1, moment=1), 2, 1)
        ...     egg.elasticity = floor.elasticity = 1
        ...     egg.body.position, egg.body.velocity = (0, 1.5), (0, -20)
        ...     space.add(floor, egg.body, egg)
        ...     for _ in range(2):
        ...         space.step(0.03)
        ...     heights.append(round(egg.body.position.y, 3))
        >>> heights  # It has gone down by 0.5 and up by 0.7.
        [1.5, 1.7]
        """
        return self._touches.contacts.exact_impacts

    @exact_impacts.setter
    def exact_impacts(self, exact: bool) -> None:
        self._touches.contacts.exact_impacts = _checks.switch("exact_impacts", exact)

    def __getstate__(self) -> dict[str, Any]:
        """What a copy or a pickle keeps: pymunk's state, and with exact impacts how those of the last step still move bodies."""
        bias = bias_velocities(self) if self.exact_impacts else []
        return {**super().__getstate__(), "bias": bias}

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        set_bias_velocities(state["bias"])

    def point_query(
        self, point: tuple[float, float], max_distance: float, shape_filter: ShapeFilter
    ) -> list[PointQueryInfo]:
        """All shapes that are nearer to the point than max_distance, with the nearest points of their surfaces.

        Inside a shape the distance is negative, and so may max_distance be: then it is the
        depth that the point must exceed. Sensors are included.

        >>> import pymunk
        >>> space = Space()
        >>> space.add(Ellipse(space.static_body, 20, 10))
        >>> [hit] = space.point_query((0, 13), 5, pymunk.ShapeFilter())
        >>> hit.point, hit.distance, hit.gradient
        (Vec2d(0.0, 10.0), 3.0, Vec2d(0.0, 1.0))
        """
        if ellipses_in(self):
            point = _checks.point("point", point)
            max_distance = _checks.number_or_infinity("max_distance", max_distance)
        return super().point_query(point, max_distance, shape_filter)

    def point_query_nearest(
        self, point: tuple[float, float], max_distance: float, shape_filter: ShapeFilter
    ) -> PointQueryInfo | None:
        """The shape nearest to the point, if nearer than max_distance; see :py:meth:`point_query`."""
        if ellipses_in(self):
            point = _checks.point("point", point)
            max_distance = _checks.number_or_infinity("max_distance", max_distance)
        return super().point_query_nearest(point, max_distance, shape_filter)

    def segment_query(
        self,
        start: tuple[float, float],
        end: tuple[float, float],
        radius: float,
        shape_filter: ShapeFilter,
    ) -> list[SegmentQueryInfo]:
        """All shapes that a circle of the given radius touches on its way from start to end, and where first.

        alpha is the part of the way before the touch, 0 to 1. For a shape that is touched at
        the start alpha is zero, and what :py:meth:`Ellipse.segment_query` says holds. Sensors
        are included.

        Of pymunk's own shapes, those whose bounding boxes the segment itself does not cross
        are not found, as in pymunk, whatever the radius.

        >>> import pymunk
        >>> space = Space()
        >>> space.add(Ellipse(space.static_body, 20, 10))
        >>> [hit] = space.segment_query((0, 50), (0, -50), 0, pymunk.ShapeFilter())
        >>> hit.point, hit.normal, hit.alpha
        (Vec2d(0.0, 10.0), Vec2d(0.0, 1.0), 0.4)
        """
        if not ellipses_in(self):
            return super().segment_query(start, end, radius, shape_filter)
        start = _checks.point("start", start)
        end = _checks.point("end", end)
        radius = _checks.number("radius", radius)
        found = super().segment_query(start, end, radius, shape_filter)
        if radius > 0.0:
            seen = {address(hit.shape._shape) for hit in found if hit.shape}
            touched = overlooked_ellipses(
                self, start, end, radius, shape_filter, ellipses_in(self)
            )
            for place, (alpha, nx, ny, px, py) in touched:
                if place not in seen:
                    shape = shape_at_address(place)
                    found.append(
                        SegmentQueryInfo(shape, Vec2d(px, py), Vec2d(nx, ny), alpha)
                    )
        return found

    def segment_query_first(
        self,
        start: tuple[float, float],
        end: tuple[float, float],
        radius: float,
        shape_filter: ShapeFilter,
    ) -> SegmentQueryInfo | None:
        """The shape that a circle of the given radius touches first on its way from start to end; see :py:meth:`segment_query`.

        One that it touches only at the end does not count, as in pymunk.
        """
        if not ellipses_in(self):
            return super().segment_query_first(start, end, radius, shape_filter)
        if _checks.number("radius", radius) > 0.0:
            # Chipmunk's own search for the first leaves out what the circle touches before its
            # middle has come to the shape's box.
            hits = self.segment_query(start, end, radius, shape_filter)
            before = (hit for hit in hits if hit.alpha < 1.0)
            return min(before, key=lambda hit: hit.alpha, default=None)
        start = _checks.point("start", start)
        end = _checks.point("end", end)
        return super().segment_query_first(start, end, radius, shape_filter)

    def bb_query(self, bb: BB, shape_filter: ShapeFilter) -> list[Shape]:
        """All shapes whose bounding boxes overlap bb. Sensors are included.

        >>> import pymunk
        >>> space = Space()
        >>> egg = Ellipse(space.static_body, 20, 10)
        >>> space.add(egg)
        >>> space.bb_query(pymunk.BB(20.5, 0, 30, 10), pymunk.ShapeFilter())
        []
        """
        if ellipses_in(self):
            bb = _checks.box("bb", bb)
        return super().bb_query(bb, shape_filter)

    def shape_query(self, shape: Shape) -> list[ShapeQueryInfo]:
        """All shapes in the space that overlap the given shape, with their contacts. Sensors are included.

        The shape may be in the space or not. Without a body it is where its update put it.
        Normals lead from it to the shapes found.

        Raises TypeError if shape is not a pymunk.Shape.

        >>> import pymunk
        >>> space = Space()
        >>> space.add(Ellipse(space.static_body, 20, 10))
        >>> circle = pymunk.Circle(space.static_body, 5, offset=(24, 0))
        >>> [hit] = space.shape_query(circle)
        >>> hit.contact_point_set.points[0].distance
        -1.0
        """
        if not isinstance(shape, Shape):
            raise TypeError(f"shape must be a pymunk.Shape, got {shape!r}")
        found = []
        for hit in super().shape_query(shape):
            if isinstance(shape, Ellipse):
                contact = shape.shapes_collide(hit.shape)
            elif isinstance(hit.shape, Ellipse):
                contact = mirrored(hit.shape.shapes_collide(shape))
            else:
                contact = hit.contact_point_set
            if contact.points:
                found.append(ShapeQueryInfo(hit.shape, contact))
        return found

    def debug_draw(self, options: SpaceDebugDrawOptions) -> None:
        """Draw the space with the given options, ellipses with their true outlines.

        An outline goes to the options' draw_polygon, with so many vertices that on the screen
        none of its edges is farther from the ellipse than a tenth of a pixel (in the
        units that the options' transform leads to) or a thousandth of its size, whichever is
        less, and with a radius of zero. A line from the centre to the end of the semi-axis a
        goes to draw_segment, so that rotation is seen.

        >>> import pymunk
        >>> class CountingOptions(pymunk.SpaceDebugDrawOptions):
        ...     def draw_polygon(self, verts, radius, outline_color, fill_color):
        ...         print(len(verts), "vertices, radius", radius)
        ...     def draw_segment(self, a, b, color):
        ...         print("from", a, "to", b)
        >>> space = Space()
        >>> space.add(Ellipse(space.static_body, 200, 100))
        >>> space.debug_draw(CountingOptions())
        100 vertices, radius 0.0
        from Vec2d(0.0, 0.0) to Vec2d(200.0, 0.0)
        """
        if ellipses_in(self):
            options = cast(SpaceDebugDrawOptions, TrueOutlines(options))
        super().debug_draw(options)


def mirrored(contact: ContactPointSet) -> ContactPointSet:
    """The contact of two shapes, seen from the second."""
    return ContactPointSet(
        -contact.normal,
        tuple(ContactPoint(p.point_b, p.point_a, p.distance) for p in contact.points),
    )
