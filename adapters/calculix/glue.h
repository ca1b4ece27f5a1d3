/* Called by nonlingeo.c of CalculiX where insert.py puts the calls; described in glue.c. */
char *feti_wish(void);
void feti_begin(ITG fits, ITG by_faces, ITG ntie, char *tieset, char *set, ITG nset, double *tietol, ITG *itietri, ITG *koncont, ITG *itiefac, ITG *islavsurf,
                ITG *nslavnode, ITG *islavnode, ITG *ipkon, ITG *kon, char *lakon, ITG nk, ITG mt, ITG neq, double *elcon, ITG values, ITG *nactdof, ITG terms,
                double *co, double *vold, double *xbounact, ITG *ipompc, ITG *nodempc, double *coefmpc);
void feti_commit(double *co, double *vold);
void feti_table(ITG *nactdof, double *xbounact, ITG *ipompc, ITG *nodempc, double *coefmpc, double *co, double *vold);
ITG feti_again(double *ad, double *au, ITG *jq, ITG *irow, double *b, ITG finite);
void feti_residual(double *b, double *qa, double *co, double *vold);
