/* The compiled library: gives numba's functions the conventions of C, above all those for structs by
   value, which differ from platform to platform, and holds the class of ellipses. */

#include <stdint.h>

#include "structs.h"

#ifdef _WIN32
#define EXPORTED __declspec(dllexport)
#define INTERNAL
/* The linker looks for this where floating point is used without the C runtime. */
int _fltused = 0;
#else
#define EXPORTED __attribute__((visibility("default")))
#define INTERNAL __attribute__((visibility("hidden")))
#endif

/* Numba's convention: a place for the result, one for an exception, then the arguments. */
int pe_native_resolve(void *, void **, int64_t, int64_t, uint8_t);
int pe_native_complete(void *, void **, int64_t, int64_t);
int pe_native_cache_data(double *, void **, void *, double, double, double, double);
int pe_native_nearest_updated(double *, void **, void *, double, double);
int pe_native_cast_updated(double *, void **, void *, double, double, double, double, double);
int pe_native_nearest_now(double *, void **, void *, double, double);
int pe_native_cast_now(double *, void **, void *, double, double, double, double, double);
int pe_native_shape_contact(double *, void **, void *, void *);
int pe_native_collect_touched(void *, void **, int64_t, int64_t);
int pe_native_contacts_of_rows(void *, void **, int64_t, const double *, int64_t, const double *, int64_t, double *);
int pe_native_nearest_of_rows(void *, void **, int64_t, const double *, int64_t, const double *, int64_t, double *);

INTERNAL ShapeClass pe_ellipse_class;
static ShapeClass polygons;

static Box cache_data(void *shape, Transform at) {
    double box[4];
    void *exception = 0;
    polygons.cache_data(shape, at);
    pe_native_cache_data(box, &exception, shape, at.a, at.b, at.tx, at.ty);
    return (Box){box[0], box[1], box[2], box[3]};
}

static void point_query(void *shape, Vect point, void *result) {
    PointQueryInfo *info = result;
    double nearest[5];
    void *exception = 0;
    pe_native_nearest_updated(nearest, &exception, shape, point.x, point.y);
    info->shape = (intptr_t)shape;
    info->distance = nearest[0];
    info->gradient = (Vect){nearest[1], nearest[2]};
    info->point = (Vect){nearest[3], nearest[4]};
}

static void segment_query(void *shape, Vect start, Vect end, double radius, void *result) {
    SegmentQueryInfo *info = result;
    double hit[5];
    void *exception = 0;
    pe_native_cast_updated(hit, &exception, shape, start.x, start.y, end.x, end.y, radius);
    if (hit[0] <= 1.0) {
        info->shape = (intptr_t)shape;
        info->alpha = hit[0];
        info->normal = (Vect){hit[1], hit[2]};
        info->point = (Vect){hit[3], hit[4]};
    }
}

EXPORTED void *pe_shape_class(const void *of_polygons) {
    polygons = *(const ShapeClass *)of_polygons;
    pe_ellipse_class = polygons;
    pe_ellipse_class.cache_data = cache_data;
    pe_ellipse_class.point_query = point_query;
    pe_ellipse_class.segment_query = segment_query;
    return &pe_ellipse_class;
}

static void resolve(void *arbiter, void *space, int exact_impacts) {
    void *result = 0, *exception = 0;
    pe_native_resolve(&result, &exception, (intptr_t)arbiter, (intptr_t)space, exact_impacts != 0);
}

static void complete(void *arbiter, void *space) {
    void *result = 0, *exception = 0;
    pe_native_complete(&result, &exception, (intptr_t)arbiter, (intptr_t)space);
}

EXPORTED void pe_resolve(void *arbiter, void *space, int exact_impacts) { resolve(arbiter, space, exact_impacts); }

EXPORTED void pe_complete(void *arbiter, void *space) { complete(arbiter, space); }

EXPORTED void pe_pre_solve(void *arbiter, void *space, void *data) {
    (void)data;
    resolve(arbiter, space, 0);
    complete(arbiter, space);
}

EXPORTED void pe_pre_solve_with_impacts(void *arbiter, void *space, void *data) {
    (void)data;
    resolve(arbiter, space, 1);
    complete(arbiter, space);
}

EXPORTED void pe_shape_contact(void *ellipse, void *shape, double *result) {
    void *exception = 0;
    pe_native_shape_contact(result, &exception, ellipse, shape);
}

EXPORTED void pe_nearest_now(void *ellipse, double x, double y, double *result) {
    void *exception = 0;
    pe_native_nearest_now(result, &exception, ellipse, x, y);
}

EXPORTED void pe_cast_now(void *ellipse, double start_x, double start_y, double end_x, double end_y,
                          double radius, double *result) {
    void *exception = 0;
    pe_native_cast_now(result, &exception, ellipse, start_x, start_y, end_x, end_y, radius);
}

EXPORTED void pe_collect_touched(void *shape, void *ray) {
    void *nothing = 0, *exception = 0;
    pe_native_collect_touched(&nothing, &exception, (intptr_t)shape, (intptr_t)ray);
}

EXPORTED void pe_contacts_of_rows(int64_t count, const double *first, int64_t first_step, const double *second,
                                  int64_t second_step, double *result) {
    void *nothing = 0, *exception = 0;
    pe_native_contacts_of_rows(&nothing, &exception, count, first, first_step, second, second_step, result);
}

EXPORTED void pe_nearest_of_rows(int64_t count, const double *ellipses, int64_t ellipse_step, const double *points,
                                 int64_t point_step, double *result) {
    void *nothing = 0, *exception = 0;
    pe_native_nearest_of_rows(&nothing, &exception, count, ellipses, ellipse_step, points, point_step, result);
}

EXPORTED const char *pe_digest(void) { return DIGEST; }
