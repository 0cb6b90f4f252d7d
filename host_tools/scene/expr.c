/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Compilation and evaluation of formulas in scenes: operator-precedence parsing (shunting-yard
 * algorithm) to code in reverse Polish notation, with stacks of limited size.
 */
#include "expr.h"
#include "expr_code.h"

#include <ctype.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { CODE = 256, STACK = EXPR_STACK };

typedef struct word {
    const char *text;
    operation op;
    int arguments;
    double number;
} word;

/*
 * Names that a formula may use, with the number of arguments of each; a variable or constant has 0
 * arguments.
 */
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

/*
 * Entry of the parser stack: an operator that waits for its right operand, or an open parenthesis
 * with the function before it.
 */
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
    int depth; /* number of values on the evaluation stack after the instructions emitted so far
                  have been executed */
    waiting stack[STACK];
    int waiting;
    bool want_value; /* true: the next symbol of the formula must be an operand; false: it must be
                        an operator */
    bool is_constant;
} parser;

static int fault(parser *parser, const char *error)
{
    parser->error = error;
    return -1;
}

int expr_arity(operation op)
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

static int emit(parser *parser, operation op, double number)
{
    if (parser->length == CODE)
        return fault(parser, "the expression is too long; shorten it");
    parser->depth += 1 - expr_arity(op);
    if (parser->depth > STACK)
        return fault(parser, "the expression is nested too deeply; shorten it");
    parser->code[parser->length].op = op;
    parser->code[parser->length].number = number;
    parser->length++;
    return 0;
}

static int push(parser *parser, operation op, const word *function)
{
    if (parser->waiting == STACK)
        return fault(parser, "the expression is nested too deeply; shorten it");
    parser->stack[parser->waiting].op = op;
    parser->stack[parser->waiting].function = function;
    parser->stack[parser->waiting].commas = 0;
    parser->waiting++;
    return 0;
}

/*
 * Move operators from the stack of the formula parser to the code as long as their precedence is at
 * least `binding`, at most down to an open parenthesis. Returns 0, or -1 if the formula is too
 * long.
 */
static int reduce(parser *parser, int binding)
{
    while (parser->waiting > 0 && precedence(parser->stack[parser->waiting - 1].op) >= binding &&
           parser->stack[parser->waiting - 1].op != OP_OPEN) {
        parser->waiting--;
        if (emit(parser, parser->stack[parser->waiting].op, 0) != 0)
            return -1;
    }
    return 0;
}

static int take_number(parser *parser)
{
    char *end;
    double number;
    if (parser->at[0] == '0' && (parser->at[1] == 'x' || parser->at[1] == 'X'))
        return fault(parser, "hexadecimal is not read; write a decimal");
    number = strtod(parser->at, &end);
    if (end == parser->at)
        return fault(parser, "a number is wanted here");
    if (!isfinite(number))
        return fault(parser, "the number is too large");
    parser->at = end;
    parser->want_value = false;
    return emit(parser, OP_NUMBER, number);
}

static const word *find_word(const char *text, size_t length)
{
    size_t i;
    for (i = 0; i < sizeof words / sizeof *words; i++)
        if (strlen(words[i].text) == length && strncmp(words[i].text, text, length) == 0)
            return &words[i];
    return NULL;
}

static void skip_blanks(parser *parser)
{
    while (*parser->at == ' ' || *parser->at == '\t' || *parser->at == '\n')
        parser->at++;
}

static int take_word(parser *parser)
{
    const char *start = parser->at, *end = parser->at;
    const word *found;
    while (isalnum((unsigned char)*end) || *end == '_')
        end++;
    found = find_word(start, (size_t)(end - start));
    if (!found)
        return fault(parser, "unknown name; known are x y z theta1 theta2 pi and sin cos tan asin "
                             "acos atan sqrt exp log "
                             "abs min max atan2 pow hypot zernike");
    parser->at = end;
    if (found->arguments == 0) {
        if (found->op != OP_NUMBER)
            parser->is_constant = false;
        parser->want_value = false;
        return emit(parser, found->op, found->number);
    }
    skip_blanks(parser);
    if (*parser->at != '(')
        return fault(parser, "a function needs its argument in parentheses");
    parser->at++;
    return push(parser, OP_OPEN, found);
}

static int take_value(parser *parser)
{
    char character = *parser->at;
    if (isdigit((unsigned char)character) || character == '.')
        return take_number(parser);
    if (isalpha((unsigned char)character))
        return take_word(parser);
    if (character == 0)
        return fault(parser, "the expression ends where a number is wanted");
    if (character != '(' && character != '-' && character != '+')
        return fault(parser, "a number, a name or '(' is wanted here");
    parser->at++;
    if (character == '(')
        return push(parser, OP_OPEN, NULL);
    if (character == '-')
        return push(parser, OP_NEGATE, NULL);
    return 0;
}

/*
 * Read a closing parenthesis in a formula, or a comma between the arguments of a function. Returns
 * 0, or -1 on a fault.
 */
static int take_bracket(parser *parser)
{
    waiting *open;
    if (reduce(parser, 0) != 0)
        return -1;
    if (parser->waiting == 0)
        return fault(parser,
                     *parser->at == ')' ? "')' without its '('" : "a comma outside a function");
    open = &parser->stack[parser->waiting - 1];
    if (*parser->at == ',') {
        if (!open->function || ++open->commas >= open->function->arguments)
            return fault(parser, "too many arguments");
        parser->want_value = true;
        parser->at++;
        return 0;
    }
    if (open->function && open->commas + 1 != open->function->arguments)
        return fault(parser, open->function->arguments == 3 ? "this function needs three arguments"
                                                            : "this function needs two arguments");
    parser->at++;
    parser->waiting--;
    return open->function ? emit(parser, open->function->op, 0) : 0;
}

static int take_operator(parser *parser)
{
    static const char signs[] = "+-*/^";
    static const operation ops[] = {OP_ADD, OP_SUBTRACT, OP_MULTIPLY, OP_DIVIDE, OP_POWER};
    const char *sign = strchr(signs, *parser->at);
    operation op;
    if (*parser->at == ')' || *parser->at == ',')
        return take_bracket(parser);
    if (!sign)
        return fault(parser, "an operator + - * / ^ is wanted here");
    if (parser->at[0] == '*' && parser->at[1] == '*')
        return fault(parser, "a power is written ^");
    op = ops[sign - signs];
    if (reduce(parser, op == OP_POWER ? precedence(op) + 1 : precedence(op)) != 0)
        return -1; /* Successive power operators (^) are evaluated from right to left. */
    parser->at++;
    parser->want_value = true;
    return push(parser, op, NULL);
}

static int parse(parser *parser)
{
    for (skip_blanks(parser); *parser->at; skip_blanks(parser))
        if ((parser->want_value ? take_value(parser) : take_operator(parser)) != 0)
            return -1;
    if (parser->want_value)
        return take_value(parser);
    if (reduce(parser, 0) != 0)
        return -1;
    return parser->waiting ? fault(parser, "a ')' is missing") : 0;
}

/*
 * Allocate a formula with room for `length` instructions and a copy of its text. Returns NULL when
 * memory runs out.
 */
static expr *new_expr(const char *text, size_t length)
{
    const size_t code = length * sizeof(instruction);
    expr *expression = malloc(sizeof *expression + code + strlen(text) + 1);
    if (!expression)
        return NULL;
    memset(expression, 0, sizeof *expression);
    expression->length = (int)length;
    expression->text = strcpy((char *)(expression->code + length), text);
    return expression;
}

expr *expr_compile(const char *text, int *column, const char **error)
{
    parser parser = {0};
    expr *expression;
    parser.text = parser.at = text;
    parser.want_value = parser.is_constant = true;
    if (parse(&parser) != 0) {
        *column = (int)(parser.at - parser.text) + 1;
        *error = parser.error;
        return NULL;
    }
    expression = new_expr(text, (size_t)parser.length);
    if (!expression) {
        *column = 1;
        *error = "out of memory";
        return NULL;
    }
    expression->is_constant = parser.is_constant;
    memcpy(expression->code, parser.code, (size_t)parser.length * sizeof *expression->code);
    return expression;
}

expr *expr_from_points(const char *text, int axes, const int *axis, size_t count,
                       const double *point, const double *value)
{
    expr *expression = new_expr(text, 0);
    if (!expression)
        return NULL;
    expression->scatter = scatter_open(axes, count, point, value);
    if (!expression->scatter) {
        expr_free(expression);
        return NULL;
    }
    expression->axes = axes;
    memcpy(expression->axis, axis, (size_t)axes * sizeof *axis);
    expression->spacing = scatter_spacing(expression->scatter);
    return expression;
}

expr *expr_from_list(const char *text, size_t count, const double *value)
{
    expr *expression = new_expr(text, 0);
    if (!expression)
        return NULL;
    expression->list = malloc((count + 1) * sizeof *value);
    if (!expression->list) {
        expr_free(expression);
        return NULL;
    }
    memcpy(expression->list, value, count * sizeof *value);
    expression->rows = (int)count;
    return expression;
}

const char *expr_text(const expr *expression)
{
    return expression->text;
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

static double apply1(operation op, double argument)
{
    switch (op) {
    case OP_NEGATE: return -argument;
    case OP_SIN: return sin(argument);
    case OP_COS: return cos(argument);
    case OP_TAN: return tan(argument);
    case OP_ASIN: return asin(argument);
    case OP_ACOS: return acos(argument);
    case OP_ATAN: return atan(argument);
    case OP_SQRT: return sqrt(argument);
    case OP_EXP: return exp(argument);
    case OP_LOG: return log(argument);
    default: return fabs(argument);
    }
}

static double divide(double left, double right)
{
    if (right != 0)
        return left / right;
    return left == 0 ? (double)NAN : copysign(HUGE_VAL, left);
}

static double apply2(operation op, double left, double right)
{
    switch (op) {
    case OP_ADD: return left + right;
    case OP_SUBTRACT: return left - right;
    case OP_MULTIPLY: return left * right;
    case OP_DIVIDE: return divide(left, right);
    case OP_POWER:
    case OP_POW: return pow(left, right);
    case OP_MIN: return left < right ? left : right;
    case OP_MAX: return left > right ? left : right;
    case OP_ATAN2: return atan2(left, right);
    default: return hypot(left, right);
    }
}

void expr_zernike_orders(int j, int *n, int *m)
{
    *n = 0;
    while ((*n + 1) * (*n + 2) / 2 < j)
        (*n)++;
    const int place = j - *n * (*n + 1) / 2;
    *m = *n % 2 ? (place - 1) / 2 * 2 + 1 : place / 2 * 2;
}

double expr_zernike_coefficient(int n, int m, int k)
{
    return (k % 2 ? -1 : 1) * exp(lgamma(n - k + 1) - lgamma(k + 1) - lgamma((n + m) / 2 - k + 1) -
                                  lgamma((n - m) / 2 - k + 1));
}

/* Return the radial Zernike polynomial R_n^m at the radius rho. */
static double radial(int n, int m, double rho)
{
    double sum = 0;
    for (int k = 0; k <= (n - m) / 2; k++)
        sum += expr_zernike_coefficient(n, m, k) * pow(rho, n - 2 * k);
    return sum;
}

/*
 * Return the Zernike polynomial of Noll index `number` in polar coordinates. Noll indices ascend
 * with the radial order n, then with the azimuthal order m; cosine terms have even indices.
 */
static double zernike(double number, double rho, double phi)
{
    int n, m;
    const int j = (int)number;
    if (!(number >= 1 && number <= 1000) || j != number)
        return (double)NAN;
    expr_zernike_orders(j, &n, &m);
    if (m == 0)
        return sqrt(n + 1) * radial(n, m, rho);
    return sqrt(2 * (n + 1)) * radial(n, m, rho) * (j % 2 ? sin(m * phi) : cos(m * phi));
}

static double formula_value(const expr *expression, const expr_point *at)
{
    double stack[STACK + 1];
    int i, top = 0;
    for (i = 0; i < expression->length; i++) {
        operation op = expression->code[i].op;
        int arity = expr_arity(op);
        if (arity == 3) {
            stack[top - 3] = zernike(stack[top - 3], stack[top - 2], stack[top - 1]);
            top -= 2;
        } else if (arity == 2) {
            stack[top - 2] = apply2(op, stack[top - 2], stack[top - 1]);
            top--;
        } else if (arity == 1) {
            stack[top - 1] = apply1(op, stack[top - 1]);
        } else {
            stack[top++] = op == OP_NUMBER ? expression->code[i].number : variable(op, at);
        }
    }
    return stack[0];
}

/*
 * Copy the coordinates of a point that are arguments of an interpolated function, in the order of
 * the function's own arguments.
 *   place [axes] out  at most 3 coordinates
 */
static void place_of(const expr *expression, const expr_point *at, double *place)
{
    const double all[EXPR_AXES] = {at->x, at->y, at->z, at->theta1, at->theta2};
    for (int axis = 0; axis < expression->axes; axis++)
        place[axis] = all[expression->axis[axis]];
}

static int is_finite_place(const double *place, int axes)
{
    for (int axis = 0; axis < axes; axis++)
        if (!isfinite(place[axis]))
            return 0;
    return 1;
}

double expr_row_value(const expr *expression, const expr_point *at, int row)
{
    double place[SCATTER_AXES] = {0, 0, 0};
    if (expression->list)
        return row >= 0 && row < expression->rows ? expression->list[row] : (double)NAN;
    if (!expression->scatter)
        return formula_value(expression, at);
    place_of(expression, at, place);
    if (!is_finite_place(place, expression->axes))
        return (double)NAN;
    return scatter_value(expression->scatter, place, NULL);
}

double expr_value(const expr *expression, const expr_point *at)
{
    return expr_row_value(expression, at, -1);
}

int expr_rows(const expr *expression)
{
    return expression->list ? expression->rows : -1;
}

double expr_gap(const expr *expression, const expr_point *at)
{
    double place[SCATTER_AXES] = {0, 0, 0}, distance;
    if (!expression->scatter || !(expression->spacing > 0))
        return 0;
    place_of(expression, at, place);
    if (!is_finite_place(place, expression->axes))
        return 0;
    (void)scatter_value(expression->scatter, place, &distance);
    return distance / expression->spacing;
}

int expr_is_constant(const expr *expression)
{
    return expression->is_constant;
}

int expr_uses_theta(const expr *expression)
{
    int i;
    for (i = 0; i < expression->length; i++)
        if (expression->code[i].op == OP_THETA1 || expression->code[i].op == OP_THETA2)
            return 1;
    for (i = 0; i < expression->axes; i++)
        if (expression->axis[i] >= 3)
            return 1;
    return 0;
}

void expr_free(expr *expression)
{
    if (!expression)
        return;
    scatter_close(expression->scatter);
    free(expression->list);
    free(expression);
}
