/* Chipmunk's structs, each up to the last field that is used, and what the compiled library exports.

   From chipmunk_structs.h of Munk2D, as pymunk 7 ships it. cffi reads this file for Python and for
   the compiler of the kernel, and the library's C code includes it. A pointer that is both followed
   and compared has two names: one for the struct, one for the address. */

typedef struct { double x, y; } Vect;
typedef struct { double a, b, c, d, tx, ty; } Transform;
typedef struct { double left, bottom, right, top; } Box;

typedef struct {
    Vect r1, r2;
    double nMass, tMass, bounce, jnAcc, jtAcc, jBias, bias;
    intptr_t hash;
} Contact;

typedef struct {
    intptr_t velocity_func, position_func;
    double m, m_inv, i, i_inv;
    Vect cog, p, v, f;
    double a, w, t;
    Transform transform;
    intptr_t userData;
    Vect v_bias;
    double w_bias;
    intptr_t space, shapes, arbiters, constraints;
} Body;

typedef struct { intptr_t type_a, type_b, functions[4], userData; } CollisionHandler;

/* static_body is Chipmunk's own, which pymunk never gives to anyone. */
typedef struct {
    int iterations;
    Vect gravity;
    double damping, idleSpeedThreshold, sleepTimeThreshold, collisionSlop, collisionBias;
    unsigned int collisionPersistence;
    intptr_t userData;
    unsigned int stamp;
    double curr_dt;
    intptr_t bodies[4], shapeIDCounter, indexes[2], constraints, arbiters[4], buffers;
    int locked;
    intptr_t handlers;
    CollisionHandler global_handler;
    unsigned char skipPostStep;
    intptr_t postStepCallbacks, static_body_at;
    Body static_body;
} Space;

typedef struct {
    int type;
    Box (*cache_data)(void *shape, Transform transform);
    void (*destroy)(void *shape);
    void (*point_query)(void *shape, Vect point, void *info);
    void (*segment_query)(void *shape, Vect start, Vect end, double radius, void *info);
} ShapeClass;

typedef struct {
    union { intptr_t klass; ShapeClass *shape_class; };
    intptr_t space;
    union { intptr_t on_body; Body *body; };
    double m, i;
    Vect cog;
    double area;
    Box bb;
    unsigned char sensor;
    double e, u;
    Vect surfaceV;
    intptr_t userData, type, group;
    unsigned int categories, mask;
    intptr_t next, prev, hashid;
} Shape;

typedef struct {
    Shape shape;
    Vect c, tc;
    double r;
} Circle;

typedef struct {
    Shape shape;
    Vect a, b, n, ta, tb, tn;
    double r;
    Vect a_tangent, b_tangent;
} Segment;

/* planes holds four numbers for each vertex: the vertex and the normal of the face that ends there,
   those in the world first, then the local ones. */
typedef struct {
    Shape shape;
    double r;
    int count;
    double *planes;
    double inline_planes[48];
} Poly;

/* The hull of an ellipse. A polygon of few vertices keeps its planes where the frames are here; a
   hull has more, which are elsewhere, and leaves that room to the ellipse. */
typedef struct {
    Shape shape;
    double r;
    int count;
    double *planes;
    double local[6];
    double world[6];
    /* The last contacts with other shapes, four words each and a normal; see contacts/handover.py. */
    intptr_t touches[16];
    double normals[8];
    /* The last step in which it touched anything. */
    intptr_t touched_in;
} Hull;

typedef struct {
    double e, u;
    Vect surface_vr;
    union { intptr_t data; Contact *last; };
    union { intptr_t a; Shape *shape_a; };
    union { intptr_t b; Shape *shape_b; };
    Body *body_a, *body_b;
    intptr_t threads[4];
    int count;
    union { intptr_t contacts; Contact *contact; };
    Vect n;
    intptr_t handlers[4];
    unsigned char swapped;
    unsigned int stamp;
    int state;
    unsigned char processCollision;
} Arbiter;

typedef struct { intptr_t shape; Vect point; double distance; Vect gradient; } PointQueryInfo;
typedef struct { intptr_t shape; Vect point, normal; double alpha; } SegmentQueryInfo;

/* The way of a circle, and room for the addresses of the ellipses that it touches and for where: five
   numbers each, see narrowphase/cast.py. */
typedef struct {
    Vect start, end;
    double radius;
    int count;
    intptr_t *touched;
    double *hits;
} WideRay;

/* What the compiled library exports. An ellipse is a Hull, a shape any shape of Chipmunk's. Results are
   numbers in a row, as the Python functions of the same name return them. */
void pe_resolve(void *arbiter, void *space, int exact_impacts);
void pe_complete(void *arbiter, void *space);
void pe_pre_solve(void *arbiter, void *space, void *data);
void pe_pre_solve_with_impacts(void *arbiter, void *space, void *data);
void *pe_shape_class(const void *of_polygons);
void pe_shape_contact(void *ellipse, void *shape, double *result);
void pe_nearest_now(void *ellipse, double x, double y, double *result);
void pe_cast_now(void *ellipse, double start_x, double start_y, double end_x, double end_y, double radius, double *result);
void pe_collect_touched(void *shape, void *ray);
void pe_contacts_of_rows(int64_t count, const double *first, int64_t first_step, const double *second, int64_t second_step, double *result);
void pe_nearest_of_rows(int64_t count, const double *ellipses, int64_t ellipse_step, const double *points, int64_t point_step, double *result);
const char *pe_digest(void);
