#include "report.h"
int report_solve(FILE *f, const analysis *a, const double *u, const double *o){(void)f;(void)a;(void)u;(void)o;return 0;}
int report_shape(FILE *f, analysis *a, const analysis_volts *v, int c){(void)f;(void)a;(void)v;(void)c;return 0;}
int report_vtk(FILE *f, const mesh *m, const report_field *q, int n){(void)f;(void)m;(void)q;(void)n;return 0;}
void report_displacement(const mesh *m, const double *u, double *v){(void)m;(void)u;(void)v;}
