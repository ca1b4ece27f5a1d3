#include <stdint.h>
#define FETI_ALL -1
#define FETI_ARGUMENT -100
#define FETI_BORROW 1
#define FETI_BUSY -3
#define FETI_CALLBACK -4
#define FETI_CANCELLED 3
#define FETI_CANDIDATES 1
#define FETI_COPY 0
#define FETI_EQUALITY 2
#define FETI_EXACT 0
#define FETI_FRICTION_OPEN 0
#define FETI_FRICTION_SLIP 2
#define FETI_FRICTION_STICK 1
#define FETI_FRICTION_UNKNOWN 4
#define FETI_FRICTION_WEAK 3
#define FETI_FULL 0
#define FETI_GAPS_CONTRADICT -7
#define FETI_HANDLE -2
#define FETI_INACCURATE 5
#define FETI_INDEFINITE -9
#define FETI_INEQUALITY 1
#define FETI_INTERNAL -11
#define FETI_IO -10
#define FETI_ITERATIONS 1
#define FETI_LOAD_NOT_HELD -6
#define FETI_LOG_NONE 0
#define FETI_LOG_PHASE 2
#define FETI_LOG_RESULT 1
#define FETI_LOG_STEP 3
#define FETI_LOWER 1
#define FETI_MARGINAL 6
#define FETI_MEMORY -1
#define FETI_NULL_SPACE -8
#define FETI_OK 0
#define FETI_OPTION_F64 1
#define FETI_OPTION_I64 2
#define FETI_OPTION_STR 3
#define FETI_ORIGIN_CANDIDATES 2
#define FETI_ORIGIN_COORDINATES 3
#define FETI_ORIGIN_EXACT 1
#define FETI_ORIGIN_FOUND 4
#define FETI_OVERFLOW -13
#define FETI_PHASE_SETUP 1
#define FETI_PHASE_SOLVE 2
#define FETI_ROW_CLOSED 1
#define FETI_ROW_OPEN 0
#define FETI_ROW_UNKNOWN 3
#define FETI_ROW_WEAK 2
#define FETI_SLIDES -14
#define FETI_SOFT 2
#define FETI_STALLED 4
#define FETI_STATE -5
#define FETI_STEP_CONJUGATE_GRADIENT 1
#define FETI_STEP_EXPANSION 2
#define FETI_STEP_NEWTON 4
#define FETI_STEP_RELEASE 3
#define FETI_TANGENTIAL 3
#define FETI_TIME 2
#define FETI_UNSUPPORTED -12
#define FETI_UPPER 2
typedef struct feti_problem feti_problem;
int32_t feti_problem_create(feti_problem **p);
int32_t feti_problem_destroy(feti_problem **p);
int32_t feti_body_add(feti_problem *p, int64_t n, int64_t *body);
int32_t feti_body_stiffness_i32(feti_problem *p, int64_t body, int64_t n, const int32_t *row_ptr, const int32_t *col, const double *val, int32_t base, int32_t storage, int32_t flags);
int32_t feti_body_stiffness_i64(feti_problem *p, int64_t body, int64_t n, const int64_t *row_ptr, const int64_t *col, const double *val, int32_t base, int32_t storage, int32_t flags);
int32_t feti_body_stiffness_split_i32(feti_problem *p, int64_t body, int64_t n, const double *diag, const int32_t *row_ptr, const int32_t *col, const double *val, int32_t base, int32_t storage, int32_t flags);
int32_t feti_body_stiffness_split_i64(feti_problem *p, int64_t body, int64_t n, const double *diag, const int64_t *row_ptr, const int64_t *col, const double *val, int32_t base, int32_t storage, int32_t flags);
int32_t feti_body_stiffness_dense(feti_problem *p, int64_t body, int64_t n, const double *k, int64_t ld, int32_t storage, int32_t flags);
int32_t feti_body_load(feti_problem *p, int64_t body, int64_t n, const double *f);
int32_t feti_body_numbering_i32(feti_problem *p, int64_t body, int64_t n, const int32_t *number, int32_t base);
int32_t feti_body_numbering_i64(feti_problem *p, int64_t body, int64_t n, const int64_t *number, int32_t base);
int32_t feti_body_coordinates(feti_problem *p, int64_t body, int32_t dim, int64_t n, const int32_t *node, const int32_t *dir, const double *xyz, int64_t ld);
int32_t feti_body_coordinates_flags(feti_problem *p, int64_t body, int32_t flags);
int32_t feti_body_null_space(feti_problem *p, int64_t body, int64_t r, int64_t n, const double *basis, int64_t ldr, int32_t flags);
int32_t feti_body_no_null_space(feti_problem *p, int64_t body);
int32_t feti_body_null_space_get(feti_problem *p, int64_t body, int64_t n, int64_t *r, double *basis, int64_t ldr);
int32_t feti_body_fixing_set(feti_problem *p, int64_t body, int64_t r, const int64_t *dof);
int32_t feti_body_fixing(feti_problem *p, int64_t body, int64_t r, int64_t *dof);
int32_t feti_body_mesh_i32(feti_problem *p, int64_t body, int64_t elements, const int32_t *ptr, const int32_t *dof, int32_t base);
int32_t feti_body_mesh_i64(feti_problem *p, int64_t body, int64_t elements, const int64_t *ptr, const int64_t *dof, int32_t base);
int32_t feti_body_element(feti_problem *p, int64_t body, int64_t e, int64_t n, const double *ke, int64_t ld);
int32_t feti_body_elements(feti_problem *p, int64_t body, int64_t first, int64_t count, const double *ke, int32_t storage);
int32_t feti_body_elements_size(feti_problem *p, int64_t body, int64_t first, int64_t count, int32_t storage, int64_t *nnz);
int32_t feti_body_held_forces(feti_problem *p, int64_t body, int64_t n, double *r);
int32_t feti_body_pieces(feti_problem *p, int64_t body, int64_t n, int64_t *piece);
typedef int32_t (*feti_operator_fn)(void *user, int64_t body, int64_t n, int64_t nrhs, const double *x, int64_t ldx, double *y, int64_t ldy);
int32_t feti_body_operator(feti_problem *p, int64_t body, int64_t n, const double *diag, feti_operator_fn kplus, feti_operator_fn k, int32_t concurrent, void *user);
int32_t feti_rows_add_i32(feti_problem *p, int32_t kind, int64_t rows, const int32_t *row_ptr, const int32_t *body, const int32_t *dof, const double *val, int32_t base, const double *rhs, int64_t *first);
int32_t feti_rows_add_i64(feti_problem *p, int32_t kind, int64_t rows, const int64_t *row_ptr, const int64_t *body, const int64_t *dof, const double *val, int32_t base, const double *rhs, int64_t *first);
int32_t feti_rows_compliance(feti_problem *p, int32_t kind, int64_t first, int64_t rows, const double *inv_k);
int32_t feti_counts(feti_problem *p, int64_t *bodies, int64_t *dofs, int64_t *rows, int64_t *eqs);
int32_t feti_friction_add_i32(feti_problem *p, int64_t nodes, int32_t dim, const int32_t *normal_row, const int32_t *row_ptr, const int32_t *body, const int32_t *dof, const double *val, int32_t base, const double *coefficient, const double *bound, int64_t *first);
int32_t feti_friction_add_i64(feti_problem *p, int64_t nodes, int32_t dim, const int64_t *normal_row, const int64_t *row_ptr, const int64_t *body, const int64_t *dof, const double *val, int32_t base, const double *coefficient, const double *bound, int64_t *first);
int32_t feti_friction_law(feti_problem *p, int64_t first, int64_t nodes, const double *coefficient, const double *bound);
int32_t feti_friction_compliance(feti_problem *p, int64_t first, int64_t nodes, const double *inv_kt);
int32_t feti_friction_counts(feti_problem *p, int64_t *nodes, int32_t *dim);
typedef struct feti_option {
  int64_t struct_size;
  int32_t type;
  int32_t reserved;
  double minimum;
  double maximum;
  double default_f64;
  int64_t default_i64;
  const char *name;
  const char *doc;
  const char *default_str;
} feti_option;
int32_t feti_set_f64(feti_problem *p, const char *name, double value);
int32_t feti_set_i64(feti_problem *p, const char *name, int64_t value);
int32_t feti_set_str(feti_problem *p, const char *name, const char *value);
int32_t feti_set_text(feti_problem *p, const char *text);
int32_t feti_get_f64(feti_problem *p, const char *name, double *value);
int32_t feti_get_i64(feti_problem *p, const char *name, int64_t *value);
int32_t feti_get_str(feti_problem *p, const char *name, char *buf, int64_t cap, int64_t *len);
int64_t feti_option_count(void);
int32_t feti_option_at(int64_t k, feti_option *out);
typedef struct feti_info {
  int64_t struct_size;
  int32_t status;
  int32_t reserved;
  int64_t bodies;
  int64_t dofs;
  int64_t rows;
  int64_t equalities;
  int64_t floating_modes;
  int64_t active;
  int64_t undetermined;
  int64_t steps;
  int64_t cg_steps;
  int64_t expansions;
  int64_t releases;
  int64_t dual_applications;
  int64_t coarse_solves;
  int64_t factorisations;
  int64_t analyses;
  double worst;
  double equilibrium;
  double balance;
  double penetration;
  double equality;
  double negative_force;
  double complementarity;
  double duality_gap;
  double energy;
  double seconds_setup;
  double seconds_solve;
  int64_t direct_solves;
  int64_t finished;
  int64_t columns_computed;
  int64_t columns_kept;
  int64_t explicit_operators;
  int64_t implicit_operators;
  int64_t factor_bytes;
  int64_t operator_bytes;
  double friction_cone;
  double friction_work;
  double friction_stick;
  int64_t nodes;
  int64_t sticking;
  int64_t slipping;
  int64_t friction_steps;
  int64_t friction_starts;
} feti_info;
int32_t feti_setup(feti_problem *p);
int32_t feti_solve(feti_problem *p, feti_info *info);
int32_t feti_cancel(feti_problem *p);
int32_t feti_displacement(feti_problem *p, int64_t body, int64_t n, double *u);
int32_t feti_multipliers(feti_problem *p, int32_t kind, int64_t rows, double *lambda);
int32_t feti_gaps(feti_problem *p, int64_t rows, double *slack);
int32_t feti_active(feti_problem *p, int64_t rows, int32_t *state);
int32_t feti_reaction(feti_problem *p, int32_t kind, int64_t body, int64_t n, double *r);
int32_t feti_amplitudes(feti_problem *p, int64_t body, int64_t r, double *alpha);
int32_t feti_friction_slips(feti_problem *p, int64_t nodes, int32_t dim, double *slip);
int32_t feti_friction_states(feti_problem *p, int64_t nodes, int32_t *state);
int32_t feti_rows_rhs(feti_problem *p, int32_t kind, int64_t first, int64_t rows, const double *rhs);
int32_t feti_friction_commit(feti_problem *p);
int32_t feti_friction_reference(feti_problem *p, int64_t first, int64_t nodes, int32_t dim, const double *s_old);
int32_t feti_start_from(feti_problem *p, int32_t kind, int64_t rows, const double *lambda);
int32_t feti_body_values(feti_problem *p, int64_t body, int64_t nnz, const double *val);
int32_t feti_body_values_split(feti_problem *p, int64_t body, int64_t n, const double *diag, int64_t nnz, const double *val);
int32_t feti_body_values_dense(feti_problem *p, int64_t body, int64_t n, const double *k, int64_t ld);
int32_t feti_rows_clear(feti_problem *p, int32_t kind);
int32_t feti_friction_clear(feti_problem *p);
int32_t feti_state_save(feti_problem *p, int64_t *id);
int32_t feti_state_restore(feti_problem *p, int64_t id);
int32_t feti_state_drop(feti_problem *p, int64_t id);
typedef struct feti_findings {
  int64_t struct_size;
  int32_t status;
  int32_t kind;
  int64_t body;
  int64_t component;
  int64_t dof;
  int64_t row;
  int64_t rows_involved;
  int64_t undetermined;
  int64_t redundant_rows;
  int64_t untouched_bodies;
  int64_t untouched_body;
  double margin;
  double motion[6];
  double unheld;
  int64_t doubtful_bodies;
  int64_t doubtful_body;
  int64_t soft_bodies;
  int64_t soft_body;
  double capacity;
} feti_findings;
int32_t feti_diagnosis(feti_problem *p, feti_findings *out);
int32_t feti_diagnosis_motion(feti_problem *p, int64_t body, int64_t n, double *v);
int32_t feti_diagnosis_rows(feti_problem *p, int32_t kind, int64_t cap, int64_t *count, int64_t *row, double *weight);
int32_t feti_diagnosis_dependent(feti_problem *p, int64_t cap, int64_t *count, int64_t *row);
int32_t feti_diagnosis_untouched(feti_problem *p, int64_t cap, int64_t *count, int64_t *body);
int32_t feti_diagnosis_undetermined(feti_problem *p, int64_t k, int64_t *body, double *motion);
int32_t feti_diagnosis_undetermined_motion(feti_problem *p, int64_t k, int64_t body, int64_t n, double *v);
typedef struct feti_body_facts {
  int64_t struct_size;
  int64_t unknowns;
  int64_t entries;
  int64_t components;
  int64_t matrix_bytes;
  int64_t borrowed;
  int64_t origin;
  int64_t null_space;
  int64_t factor_entries;
  int64_t factor_bytes;
  int64_t shared_with;
  int64_t explicit_operator;
  int64_t operator_bytes;
  double gap;
  double force_error;
  int64_t soft_free;
  int64_t soft_held;
  double softness;
  double softness_of_rounding;
  int64_t pieces;
} feti_body_facts;
typedef struct feti_phase {
  int64_t struct_size;
  int64_t bytes;
  double seconds;
  const char *name;
} feti_phase;
int32_t feti_body_info(feti_problem *p, int64_t body, feti_body_facts *out);
int32_t feti_body_components(feti_problem *p, int64_t body, int64_t n, int64_t *component);
int32_t feti_phase_count(feti_problem *p, int64_t *count);
int32_t feti_phase_at(feti_problem *p, int64_t k, feti_phase *out);
typedef struct feti_progress {
  int64_t struct_size;
  int32_t phase;
  int32_t step;
  int64_t steps;
  int64_t products;
  int64_t active;
  double residual;
  double residual_free;
  double residual_chopped;
  double theta;
  double seconds;
  double fraction;
} feti_progress;
typedef int32_t (*feti_progress_fn)(void *user, const feti_progress *now);
typedef int32_t (*feti_log_fn)(void *user, int32_t level, const char *text);
int32_t feti_on_progress(feti_problem *p, feti_progress_fn callback, void *user);
int32_t feti_on_log(feti_problem *p, feti_log_fn callback, int32_t level, void *user);
typedef struct feti_certificate {
  int64_t struct_size;
  int32_t passed;
  int32_t reserved;
  double limit;
  double worst;
  double equilibrium;
  double balance;
  double penetration;
  double equality;
  double negative_force;
  double complementarity;
  double duality_gap;
  int64_t equilibrium_body;
  int64_t balance_body;
  int64_t penetration_row;
  int64_t equality_row;
  int64_t force_row;
  int64_t complementarity_row;
  double friction_cone;
  double friction_work;
  double friction_stick;
  int64_t friction_cone_node;
  int64_t friction_work_node;
  int64_t friction_stick_node;
} feti_certificate;
int32_t feti_check(feti_problem *p, int64_t n, const double *u, int64_t rows, const double *lambda, int64_t eqs, const double *mu, feti_certificate *out);
int32_t feti_check_friction(feti_problem *p, int64_t n, const double *u, int64_t rows, const double *lambda, int64_t eqs, const double *mu, int64_t nodes, int32_t dim, const double *lambda_t, feti_certificate *out);
int32_t feti_body_kplus(feti_problem *p, int64_t body, int64_t n, int64_t nrhs, const double *x, int64_t ldx, double *y, int64_t ldy);
int32_t feti_dual_apply(feti_problem *p, int64_t m, const double *x, double *y);
int32_t feti_dual_rhs(feti_problem *p, int64_t m, double *d);
int32_t feti_problem_write(feti_problem *p, const char *path);
int32_t feti_problem_read(feti_problem *p, const char *path);
typedef struct feti_error_detail {
  int64_t struct_size;
  int32_t status;
  int32_t argument;
  int64_t body;
  int64_t component;
  int64_t dof;
  int64_t row;
  int64_t entry;
  double value;
  double limit;
  char function[40];
  int64_t element;
  int64_t node;
} feti_error_detail;
int64_t feti_last_error(char *buf, int64_t cap);
int32_t feti_last_error_detail(feti_error_detail *out);
int32_t feti_problem_error(feti_problem *p, char *buf, int64_t cap, int64_t *len);
const char *feti_status_name(int32_t status);
const char *feti_status_text(int32_t status);
const char *feti_version(void);
int32_t feti_version_number(void);
