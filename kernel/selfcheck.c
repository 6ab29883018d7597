/* Runs every entry of a compiled library on the same random numbers on every platform, and prints a
   digest of the results' bits: `selfcheck LIBRARY`. See selfcheck.py. */

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "structs.h"

#ifdef _WIN32
#include <windows.h>
typedef HMODULE Library;
static Library load(const char *path) { return LoadLibraryA(path); }
static void *symbol(Library library, const char *name) {
    return (void *)(intptr_t)GetProcAddress(library, name);
}
#else
#include <dlfcn.h>
typedef void *Library;
static Library load(const char *path) { return dlopen(path, RTLD_NOW); }
static void *symbol(Library library, const char *name) { return dlsym(library, name); }
#endif

enum { PAIRS = 20000 };
enum Kind { CIRCLE, SEGMENT, POLYGON, ELLIPSE, KINDS };

typedef union {
    Shape shape;
    Circle circle;
    Segment segment;
    Poly polygon;
    Hull hull;
} AnyShape;

/* Only additions, products, quotients and roots, which are the same everywhere to the last bit. */

static uint64_t state = 1;

static double uniform(double low, double high) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * ((double)(state >> 11) / 9007199254740992.0);
}

static int one_of(int count) { return (int)uniform(0, count); }

static double root(double square) {
    double x = square > 1 ? square : 1;
    for (int i = 0; i < 60; i++) x = 0.5 * (x + square / x);
    return x;
}

/* A unit vector by the tangent of half its angle. */
static Vect unit(double t) {
    double square = t * t;
    return (Vect){(1 - square) / (1 + square), 2 * t / (1 + square)};
}

static Vect direction(void) {
    Vect v = unit(uniform(-1, 1));
    return one_of(2) ? v : (Vect){-v.x, -v.y};
}

/* Mostly small, some large. */
static double length(void) { return 1 / uniform(0.02, 1); }

static Vect point(double reach) { return (Vect){uniform(-reach, reach), uniform(-reach, reach)}; }

static Vect moved(Transform at, Vect v) {
    return (Vect){at.a * v.x + at.c * v.y + at.tx, at.b * v.x + at.d * v.y + at.ty};
}

static Vect turned(Transform at, Vect v) {
    return (Vect){at.a * v.x + at.c * v.y, at.b * v.x + at.d * v.y};
}

/* The classes of pymunk's own shapes: the library reads their types, and updates a hull through that
   of polygons. */

static Box no_box(void *shape, Transform at) {
    (void)shape;
    return (Box){at.tx, at.ty, at.tx, at.ty};
}

static ShapeClass classes[] = {{CIRCLE, no_box, 0, 0, 0}, {SEGMENT, no_box, 0, 0, 0}, {POLYGON, no_box, 0, 0, 0}};
static ShapeClass *ellipses;

static Body random_body(Vect around, double reach) {
    Body body = {0};
    Vect along = direction(), off = point(reach), gravity = point(1);
    body.transform = (Transform){along.x, along.y, -along.y, along.x, around.x + off.x, around.y + off.y};
    body.p = (Vect){body.transform.tx + gravity.x, body.transform.ty + gravity.y};
    body.v = point(50);
    body.w = uniform(-3, 3);
    body.m = uniform(0.5, 2);
    body.m_inv = 1 / body.m;
    body.i = uniform(10, 200);
    body.i_inv = 1 / body.i;
    return body;
}

static void random_circle(Circle *circle) {
    circle->c = point(3);
    circle->r = length();
}

static void random_segment(Segment *segment) {
    segment->a = point(30);
    segment->b = point(30);
    Vect along = {segment->b.x - segment->a.x, segment->b.y - segment->a.y};
    double reach = root(along.x * along.x + along.y * along.y);
    segment->n = (Vect){along.y / reach, -along.x / reach};
    segment->r = one_of(2) ? 0 : uniform(0, 3);
    if (one_of(2)) segment->a_tangent = point(10);
    if (one_of(2)) segment->b_tangent = point(10);
}

/* Vertices of a stretched circle, in order, and the normal of the face that ends at each. */
static void random_polygon(Poly *polygon) {
    double width = length(), height = length();
    int count = polygon->count = 3 + one_of(4);
    double *planes = polygon->planes = polygon->inline_planes;
    polygon->r = one_of(2) ? 0 : uniform(0, 1);
    for (int i = 0; i < count; i++) {
        double u = 2 * (i + uniform(0.2, 0.8)) / count - 1;
        Vect corner = unit(u / (1 - (u < 0 ? -u : u)));
        double *plane = planes + 4 * (count + i);
        plane[0] = width * corner.x;
        plane[1] = height * corner.y;
    }
    for (int i = 0; i < count; i++) {
        double *to = planes + 4 * (count + i), *from = planes + 4 * (count + (i + count - 1) % count);
        double x = to[0] - from[0], y = to[1] - from[1], reach = root(x * x + y * y);
        to[2] = y / reach;
        to[3] = -x / reach;
    }
}

/* Up to a thousand times as long as wide; some are circles. */
static void random_ellipse(Hull *hull) {
    Vect along = direction(), center = point(3);
    double a = length(), share = uniform(0, 1);
    double b = one_of(8) ? a * (0.001 + 0.999 * share * share * share) : a;
    double frame[] = {a, b, along.x, along.y, center.x, center.y};
    memcpy(hull->local, frame, sizeof frame);
}

static void random_shape(AnyShape *any, int kind, Body *body) {
    memset(any, 0, sizeof *any);
    any->shape.shape_class = kind == ELLIPSE ? ellipses : &classes[kind];
    any->shape.body = body;
    if (one_of(2)) any->shape.surfaceV = point(2);
    if (kind == CIRCLE) random_circle(&any->circle);
    if (kind == SEGMENT) random_segment(&any->segment);
    if (kind == POLYGON) random_polygon(&any->polygon);
    if (kind == ELLIPSE) random_ellipse(&any->hull);
}

/* What Chipmunk does with a shape before it looks for collisions. */
static void update(AnyShape *any, int kind) {
    Transform at = any->shape.body->transform;
    if (kind == CIRCLE) any->circle.tc = moved(at, any->circle.c);
    if (kind == SEGMENT) {
        any->segment.ta = moved(at, any->segment.a);
        any->segment.tb = moved(at, any->segment.b);
        any->segment.tn = turned(at, any->segment.n);
    }
    if (kind == POLYGON) {
        double *planes = any->polygon.planes;
        int count = any->polygon.count;
        for (int i = 0; i < count; i++) {
            double *local = planes + 4 * (count + i);
            Vect vertex = moved(at, (Vect){local[0], local[1]}), normal = turned(at, (Vect){local[2], local[3]});
            double world[] = {vertex.x, vertex.y, normal.x, normal.y};
            memcpy(planes + 4 * i, world, sizeof world);
        }
    }
    any->shape.bb = any->shape.shape_class->cache_data(any, at);
}

/* What an entry returned: a digest of all its results (FNV-1a), how many were hits, and how many numbers
   were none. */
typedef struct { const char *name; uint64_t digest; long hits, nans; } Results;

static void add(Results *results, const double *numbers, int count) {
    const unsigned char *bytes = (const unsigned char *)numbers;
    for (int i = 0; i < count; i++) results->nans += numbers[i] != numbers[i];
    for (size_t i = 0; i < count * sizeof *numbers; i++)
        results->digest = (results->digest ^ bytes[i]) * 0x100000001b3u;
}

#define RESULTS(entry) static Results entry##_results = {#entry, 0xcbf29ce484222325u, 0, 0}
RESULTS(cache_data);
RESULTS(point_query);
RESULTS(segment_query);
RESULTS(nearest_now);
RESULTS(cast_now);
RESULTS(collect_touched);
RESULTS(shape_contact);
RESULTS(pre_solve);
RESULTS(pre_solve_with_impacts);
RESULTS(contacts_of_rows);
RESULTS(nearest_of_rows);

static Results *all_results[] = {
    &cache_data_results, &point_query_results, &segment_query_results, &nearest_now_results,
    &cast_now_results, &collect_touched_results, &shape_contact_results, &pre_solve_results,
    &pre_solve_with_impacts_results, &contacts_of_rows_results, &nearest_of_rows_results,
};

/* The entries of the library. */
static __typeof__(pe_digest) *digest;
static __typeof__(pe_shape_class) *shape_class;
static __typeof__(pe_pre_solve) *pre_solve;
static __typeof__(pe_pre_solve_with_impacts) *pre_solve_with_impacts;
static __typeof__(pe_shape_contact) *shape_contact;
static __typeof__(pe_nearest_now) *nearest_now;
static __typeof__(pe_cast_now) *cast_now;
static __typeof__(pe_collect_touched) *collect_touched;
static __typeof__(pe_contacts_of_rows) *contacts_of_rows;
static __typeof__(pe_nearest_of_rows) *nearest_of_rows;

static int has_entries(Library library) {
#define ENTRY(name) ((name = (__typeof__(pe_##name) *)(intptr_t)symbol(library, "pe_" #name)) != 0)
    return ENTRY(digest) && ENTRY(shape_class) && ENTRY(pre_solve) && ENTRY(pre_solve_with_impacts) &&
           ENTRY(shape_contact) && ENTRY(nearest_now) && ENTRY(cast_now) && ENTRY(collect_touched) &&
           ENTRY(contacts_of_rows) && ENTRY(nearest_of_rows);
}

static void check_queries(AnyShape *any) {
    Transform *at = &any->shape.body->transform;
    Vect start = point(15), end = point(60);
    start = (Vect){start.x + at->tx, start.y + at->ty};
    end = (Vect){end.x + at->tx, end.y + at->ty};
    double radius = one_of(2) ? 0 : uniform(0, 3), numbers[5];

    PointQueryInfo nearest = {0};
    ellipses->point_query(any, start, &nearest);
    add(&point_query_results, &nearest.point.x, 5);
    point_query_results.hits += nearest.distance <= 0;

    SegmentQueryInfo hit = {0};
    ellipses->segment_query(any, start, end, radius, &hit);
    add(&segment_query_results, &hit.point.x, 5);
    segment_query_results.hits += hit.shape != 0;

    nearest_now(any, start.x, start.y, numbers);
    add(&nearest_now_results, numbers, 5);
    nearest_now_results.hits += numbers[0] <= 0;

    cast_now(any, start.x, start.y, end.x, end.y, radius, numbers);
    add(&cast_now_results, numbers, 5);
    cast_now_results.hits += numbers[0] <= 1;

    intptr_t touched;
    WideRay ray = {start, end, radius, 0, &touched, numbers};
    memset(numbers, 0, sizeof numbers);
    collect_touched(any, &ray);
    add(&collect_touched_results, numbers, 5);
    collect_touched_results.hits += ray.count;
}

static void check_arbiter(AnyShape *any, const int *kinds, Body *bodies) {
    int with_impacts = one_of(2), swapped = one_of(2);
    Results *results = with_impacts ? &pre_solve_with_impacts_results : &pre_solve_results;
    Contact contacts[3];
    Arbiter arbiter = {0};
    Space space = {0};
    space.iterations = 10;
    space.gravity = point(100);
    space.collisionSlop = 0.1;
    space.curr_dt = 1.0 / 64;
    arbiter.e = one_of(2) ? 0 : uniform(0, 1);
    arbiter.u = uniform(0, 1);
    arbiter.shape_a = &any[swapped].shape;
    arbiter.shape_b = &any[!swapped].shape;
    arbiter.body_a = &bodies[swapped];
    arbiter.body_b = &bodies[!swapped];
    memset(contacts, 0, sizeof contacts);
    /* The first contact has nothing before it; those after it start from the last one, with its impulses. */
    for (int step = 0; step < 3; step++) {
        Contact *contact = arbiter.contact = &contacts[step];
        space.stamp = step + 1;
        arbiter.n = direction();
        arbiter.count = 2;
        arbiter.state = step ? 1 : 0;
        arbiter.surface_vr = point(1);
        (with_impacts ? pre_solve_with_impacts : pre_solve)(&arbiter, &space, 0);
        double numbers[] = {
            arbiter.count, arbiter.state, arbiter.e, arbiter.n.x, arbiter.n.y, contact->r1.x, contact->r1.y,
            contact->r2.x, contact->r2.y, contact->jnAcc, contact->jtAcc, contact->bounce, arbiter.surface_vr.x,
            arbiter.surface_vr.y,
        };
        add(results, numbers, sizeof numbers / sizeof *numbers);
        results->hits += arbiter.data != 0;
        contact->jnAcc = uniform(0, 5);
        contact->jtAcc = uniform(-1, 1);
        for (int i = 0; i < 2; i++) {
            Body *body = &bodies[i];
            Transform *at = &body->transform;
            double moves[] = {body->p.x, body->p.y, body->v.x, body->v.y, body->w, body->v_bias.x, body->v_bias.y, body->w_bias};
            add(results, moves, sizeof moves / sizeof *moves);
            Vect turn = unit(uniform(-0.02, 0.02)), was = {at->a, at->b}, way = point(0.05);
            at->a = at->d = turn.x * was.x - turn.y * was.y;
            at->b = turn.y * was.x + turn.x * was.y;
            at->c = -at->b;
            at->tx += way.x;
            at->ty += way.y;
            body->p.x += way.x;
            body->p.y += way.y;
            update(&any[i], kinds[i]);
        }
    }
}

/* The angles are zero: their sines and cosines are the C library's. */
static void random_row(double *row, Vect center) {
    double numbers[] = {length(), length(), center.x, center.y, 0};
    memcpy(row, numbers, sizeof numbers);
}

static void check_rows(void) {
    enum { COUNT = 16 };
    double first[5 * COUNT], second[5 * COUNT], points[2 * COUNT], found[7 * COUNT];
    for (int i = 0; i < COUNT; i++) {
        Vect off = point(20);
        random_row(first + 5 * i, point(5));
        random_row(second + 5 * i, off);
        memcpy(points + 2 * i, &off, sizeof off);
    }
    contacts_of_rows(COUNT, first, 5, second, 5, found);
    add(&contacts_of_rows_results, found, 7 * COUNT);
    for (int i = 0; i < COUNT; i++) contacts_of_rows_results.hits += found[7 * i] <= 0;
    nearest_of_rows(COUNT, first, 5, points, 2, found);
    add(&nearest_of_rows_results, found, 5 * COUNT);
    for (int i = 0; i < COUNT; i++) nearest_of_rows_results.hits += found[5 * i] <= 0;
}

int main(int count, char **arguments) {
    Library library = count == 2 ? load(arguments[1]) : 0;
    if (!library) {
        fprintf(stderr, "selfcheck: cannot load %s\n", count == 2 ? arguments[1] : "anything: one argument is needed");
        return 2;
    }
    if (!has_entries(library)) {
        fprintf(stderr, "selfcheck: %s lacks an entry\n", arguments[1]);
        return 2;
    }
    ellipses = shape_class(&classes[POLYGON]);

    for (int i = 0; i < PAIRS; i++) {
        AnyShape any[2];
        int kinds[] = {ELLIPSE, one_of(KINDS)};
        Body bodies[] = {random_body((Vect){0, 0}, 100), {0}};
        bodies[1] = random_body((Vect){bodies[0].transform.tx, bodies[0].transform.ty}, 8);
        for (int j = 0; j < 2; j++) {
            random_shape(&any[j], kinds[j], &bodies[j]);
            update(&any[j], kinds[j]);
        }
        add(&cache_data_results, &any[0].shape.bb.left, 4);
        add(&cache_data_results, any[0].hull.world, 6);
        check_queries(&any[0]);

        double numbers[7];
        shape_contact(&any[0], &any[1], numbers);
        add(&shape_contact_results, numbers, 7);
        shape_contact_results.hits += numbers[0] <= 0;
        check_arbiter(any, kinds, bodies);
    }
    for (int i = 0; i < PAIRS / 16; i++) check_rows();

    int failed = 0;
    printf("sources %s\n", digest());
    for (size_t i = 0; i < sizeof all_results / sizeof *all_results; i++) {
        Results *r = all_results[i];
        printf("%s %08x%08x %ld hits\n", r->name, (unsigned)(r->digest >> 32), (unsigned)r->digest, r->hits);
        if (r->nans) {
            fprintf(stderr, "selfcheck: %s made %ld numbers that are none\n", r->name, r->nans);
            failed = 1;
        }
    }
    return failed;
}
