/* Expressions of scenes: operator precedence parsing (shunting yard) to reverse Polish code, all
 * stacks bounded. */
#include "expr.h"

#include <ctype.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { CODE = 256, STACK = 64 };

typedef enum operation {
    OP_NUMBER,
    OP_X,
    OP_Y,
    OP_Z,
    OP_THETA1,
    OP_THETA2,
    OP_OPEN,
    OP_ADD,
    OP_SUBTRACT,
    OP_MULTIPLY,
    OP_DIVIDE,
    OP_NEGATE,
    OP_POWER,
    OP_SIN,
    OP_COS,
    OP_TAN,
    OP_ASIN,
    OP_ACOS,
    OP_ATAN,
    OP_SQRT,
    OP_EXP,
    OP_LOG,
    OP_ABS,
    OP_MIN,
    OP_MAX,
    OP_ATAN2,
    OP_POW,
    OP_HYPOT,
    OP_ZERNIKE
} operation;

typedef struct instruction {
    operation op;
    double number;
} instruction;

struct expr {
    int length, constant;
    instruction code[];
};

typedef struct word {
    const char *text;
    operation op;
    int arguments;
    double number;
} word;

/* Names, with the number of arguments (0: a value). */
static const word words[] = {
    {"x", OP_X, 0, 0},           {"y", OP_Y, 0, 0},
    {"z", OP_Z, 0, 0},           {"theta1", OP_THETA1, 0, 0},
    {"theta2", OP_THETA2, 0, 0}, {"pi", OP_NUMBER, 0, 3.14159265358979323846},
    {"sin", OP_SIN, 1, 0},       {"cos", OP_COS, 1, 0},
    {"tan", OP_TAN, 1, 0},       {"asin", OP_ASIN, 1, 0},
    {"acos", OP_ACOS, 1, 0},     {"atan", OP_ATAN, 1, 0},
    {"sqrt", OP_SQRT, 1, 0},     {"exp", OP_EXP, 1, 0},
    {"log", OP_LOG, 1, 0},       {"abs", OP_ABS, 1, 0},
    {"min", OP_MIN, 2, 0},       {"max", OP_MAX, 2, 0},
    {"atan2", OP_ATAN2, 2, 0},   {"pow", OP_POW, 2, 0},
    {"hypot", OP_HYPOT, 2, 0},   {"zernike", OP_ZERNIKE, 3, 0},
};

/* An operator or open parenthesis that waits; an open parenthesis carries its function. */
typedef struct waiting {
    operation op;
    const word *function;
    int commas;
} waiting;

typedef struct parser {
    const char *text, *at;
    const char *error;
    instruction code[CODE];
    int length;
    int depth; /* values on the evaluation stack after the code so far */
    waiting stack[STACK];
    int waiting;
    int want_value; /* an operand comes next, not an operator */
    int constant;
} parser;

static int fault(parser *p, const char *error)
{
    p->error = error;
    return -1;
}

static int arity(operation op)
{
    if (op < OP_OPEN)
        return 0;
    if (op == OP_NEGATE || (op >= OP_SIN && op <= OP_ABS))
        return 1;
    return op == OP_ZERNIKE ? 3 : 2;
}

static int precedence(operation op)
{
    switch (op) {
    case OP_ADD:
    case OP_SUBTRACT: return 1;
    case OP_MULTIPLY:
    case OP_DIVIDE: return 2;
    case OP_NEGATE: return 3;
    case OP_POWER: return 4;
    default: return 0;
    }
}

static int emit(parser *p, operation op, double number)
{
    if (p->length == CODE)
        return fault(p, "the expression is too long; shorten it");
    p->depth += 1 - arity(op);
    if (p->depth > STACK)
        return fault(p, "the expression is nested too deeply; shorten it");
    p->code[p->length].op = op;
    p->code[p->length].number = number;
    p->length++;
    return 0;
}

static int push(parser *p, operation op, const word *function)
{
    if (p->waiting == STACK)
        return fault(p, "the expression is nested too deeply; shorten it");
    p->stack[p->waiting].op = op;
    p->stack[p->waiting].function = function;
    p->stack[p->waiting].commas = 0;
    p->waiting++;
    return 0;
}

/* Emit the waiting operators that bind at least as strongly as `binding`, down to an open
 * parenthesis. */
static int reduce(parser *p, int binding)
{
    while (p->waiting > 0 && precedence(p->stack[p->waiting - 1].op) >= binding &&
           p->stack[p->waiting - 1].op != OP_OPEN) {
        p->waiting--;
        if (emit(p, p->stack[p->waiting].op, 0) != 0)
            return -1;
    }
    return 0;
}

static int take_number(parser *p)
{
    char *end;
    double number;
    if (p->at[0] == '0' && (p->at[1] == 'x' || p->at[1] == 'X'))
        return fault(p, "hexadecimal is not read; write a decimal");
    number = strtod(p->at, &end);
    if (end == p->at)
        return fault(p, "a number is wanted here");
    if (!isfinite(number))
        return fault(p, "the number is too large");
    p->at = end;
    p->want_value = 0;
    return emit(p, OP_NUMBER, number);
}

static const word *find_word(const char *text, size_t length)
{
    size_t i;
    for (i = 0; i < sizeof words / sizeof *words; i++)
        if (strlen(words[i].text) == length && strncmp(words[i].text, text, length) == 0)
            return &words[i];
    return NULL;
}

static void skip_blanks(parser *p)
{
    while (*p->at == ' ' || *p->at == '\t' || *p->at == '\n')
        p->at++;
}

static int take_word(parser *p)
{
    const char *start = p->at, *end = p->at;
    const word *w;
    while (isalnum((unsigned char)*end) || *end == '_')
        end++;
    w = find_word(start, (size_t)(end - start));
    if (!w)
        return fault(
            p,
            "unknown name; known are x y z theta1 theta2 pi and sin cos tan asin acos atan sqrt exp log "
            "abs min max atan2 pow hypot zernike");
    p->at = end;
    if (w->arguments == 0) {
        if (w->op != OP_NUMBER)
            p->constant = 0;
        p->want_value = 0;
        return emit(p, w->op, w->number);
    }
    skip_blanks(p);
    if (*p->at != '(')
        return fault(p, "a function needs its argument in parentheses");
    p->at++;
    return push(p, OP_OPEN, w);
}

static int take_value(parser *p)
{
    char c = *p->at;
    if (isdigit((unsigned char)c) || c == '.')
        return take_number(p);
    if (isalpha((unsigned char)c))
        return take_word(p);
    if (c == 0)
        return fault(p, "the expression ends where a number is wanted");
    if (c != '(' && c != '-' && c != '+')
        return fault(p, "a number, a name or '(' is wanted here");
    p->at++;
    if (c == '(')
        return push(p, OP_OPEN, NULL);
    if (c == '-')
        return push(p, OP_NEGATE, NULL);
    return 0;
}

/* Close a parenthesis, or start the next argument of its function. */
static int take_bracket(parser *p)
{
    waiting *open;
    if (reduce(p, 0) != 0)
        return -1;
    if (p->waiting == 0)
        return fault(p, *p->at == ')' ? "')' without its '('" : "a comma outside a function");
    open = &p->stack[p->waiting - 1];
    if (*p->at == ',') {
        if (!open->function || ++open->commas >= open->function->arguments)
            return fault(p, "too many arguments");
        p->want_value = 1;
        p->at++;
        return 0;
    }
    if (open->function && open->commas + 1 != open->function->arguments)
        return fault(p, open->function->arguments == 3 ? "this function needs three arguments"
                                                       : "this function needs two arguments");
    p->at++;
    p->waiting--;
    return open->function ? emit(p, open->function->op, 0) : 0;
}

static int take_operator(parser *p)
{
    static const char signs[] = "+-*/^";
    static const operation ops[] = {OP_ADD, OP_SUBTRACT, OP_MULTIPLY, OP_DIVIDE, OP_POWER};
    const char *sign = strchr(signs, *p->at);
    operation op;
    if (*p->at == ')' || *p->at == ',')
        return take_bracket(p);
    if (!sign)
        return fault(p, "an operator + - * / ^ is wanted here");
    if (p->at[0] == '*' && p->at[1] == '*')
        return fault(p, "a power is written ^");
    op = ops[sign - signs];
    if (reduce(p, op == OP_POWER ? precedence(op) + 1 : precedence(op)) != 0)
        return -1; /* ^ binds from the right */
    p->at++;
    p->want_value = 1;
    return push(p, op, NULL);
}

static int parse(parser *p)
{
    for (skip_blanks(p); *p->at; skip_blanks(p))
        if ((p->want_value ? take_value(p) : take_operator(p)) != 0)
            return -1;
    if (p->want_value)
        return take_value(p);
    if (reduce(p, 0) != 0)
        return -1;
    return p->waiting ? fault(p, "a ')' is missing") : 0;
}

expr *expr_compile(const char *text, int *column, const char **error)
{
    parser p = {0};
    expr *e;
    p.text = p.at = text;
    p.want_value = p.constant = 1;
    if (parse(&p) != 0) {
        *column = (int)(p.at - p.text) + 1;
        *error = p.error;
        return NULL;
    }
    e = malloc(sizeof *e + (size_t)p.length * sizeof *e->code);
    if (!e) {
        *column = 1;
        *error = "out of memory";
        return NULL;
    }
    e->length = p.length;
    e->constant = p.constant;
    memcpy(e->code, p.code, (size_t)p.length * sizeof *e->code);
    return e;
}

static double variable(operation op, const expr_point *at)
{
    switch (op) {
    case OP_X: return at->x;
    case OP_Y: return at->y;
    case OP_Z: return at->z;
    case OP_THETA1: return at->theta1;
    default: return at->theta2;
    }
}

static double apply1(operation op, double a)
{
    switch (op) {
    case OP_NEGATE: return -a;
    case OP_SIN: return sin(a);
    case OP_COS: return cos(a);
    case OP_TAN: return tan(a);
    case OP_ASIN: return asin(a);
    case OP_ACOS: return acos(a);
    case OP_ATAN: return atan(a);
    case OP_SQRT: return sqrt(a);
    case OP_EXP: return exp(a);
    case OP_LOG: return log(a);
    default: return fabs(a);
    }
}

static double divide(double a, double b)
{
    if (b != 0)
        return a / b;
    return a == 0 ? (double)NAN : copysign(HUGE_VAL, a);
}

static double apply2(operation op, double a, double b)
{
    switch (op) {
    case OP_ADD: return a + b;
    case OP_SUBTRACT: return a - b;
    case OP_MULTIPLY: return a * b;
    case OP_DIVIDE: return divide(a, b);
    case OP_POWER:
    case OP_POW: return pow(a, b);
    case OP_MIN: return a < b ? a : b;
    case OP_MAX: return a > b ? a : b;
    case OP_ATAN2: return atan2(a, b);
    default: return hypot(a, b);
    }
}

/* R_n^m(rho) = sum_k (-1)^k (n-k)! / (k! ((n+m)/2-k)! ((n-m)/2-k)!) rho^(n-2k) */
static double radial(int n, int m, double rho)
{
    double sum = 0;
    int k;
    for (k = 0; k <= (n - m) / 2; k++)
        sum += (k % 2 ? -1 : 1) *
               exp(lgamma(n - k + 1) - lgamma(k + 1) - lgamma((n + m) / 2 - k + 1) -
                   lgamma((n - m) / 2 - k + 1)) *
               pow(rho, n - 2 * k);
    return sum;
}

/* Noll's order: n ascending, within it m ascending, cosines of even number. */
static double zernike(double number, double rho, double phi)
{
    int n = 0, j = (int)number, m;
    if (!(number >= 1 && number <= 1000) || j != number)
        return (double)NAN;
    while ((n + 1) * (n + 2) / 2 < j)
        n++;
    m = j - n * (n + 1) / 2;
    m = n % 2 ? (m - 1) / 2 * 2 + 1 : m / 2 * 2;
    if (m == 0)
        return sqrt(n + 1) * radial(n, m, rho);
    return sqrt(2 * (n + 1)) * radial(n, m, rho) * (j % 2 ? sin(m * phi) : cos(m * phi));
}

double expr_value(const expr *e, const expr_point *at)
{
    double stack[STACK + 1];
    int i, top = 0;
    for (i = 0; i < e->length; i++) {
        operation op = e->code[i].op;
        int n = arity(op);
        if (n == 3) {
            stack[top - 3] = zernike(stack[top - 3], stack[top - 2], stack[top - 1]);
            top -= 2;
        } else if (n == 2) {
            stack[top - 2] = apply2(op, stack[top - 2], stack[top - 1]);
            top--;
        } else if (n == 1) {
            stack[top - 1] = apply1(op, stack[top - 1]);
        } else {
            stack[top++] = op == OP_NUMBER ? e->code[i].number : variable(op, at);
        }
    }
    return stack[0];
}

int expr_is_constant(const expr *e)
{
    return e->constant;
}

int expr_uses_theta(const expr *e)
{
    int i;
    for (i = 0; i < e->length; i++)
        if (e->code[i].op == OP_THETA1 || e->code[i].op == OP_THETA2)
            return 1;
    return 0;
}

void expr_free(expr *e)
{
    free(e);
}
