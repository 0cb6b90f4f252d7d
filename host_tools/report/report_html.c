/* Words of the report pages (report_html.h). */
#include "report_html.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- text and numbers ------------------------------------------------- */

void html_text(FILE *file, const char *text)
{
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c == '&')
            fputs("&amp;", file);
        else if (c == '<')
            fputs("&lt;", file);
        else if (c == '>')
            fputs("&gt;", file);
        else if (c == '"')
            fputs("&quot;", file);
        else if (c == '\'')
            fputs("&#39;", file);
        else if (c >= ' ' && c != 127)
            fputc(c, file);
        else if (c == '\n' || c == '\t')
            fputc(' ', file);
    }
}

static const char *const raised[10] = {"&#8304;", "&sup1;",  "&sup2;",  "&sup3;",  "&#8308;",
                                       "&#8309;", "&#8310;", "&#8311;", "&#8312;", "&#8313;"};

static void power_of_ten(FILE *file, int exponent)
{
    fprintf(file, "&times;10%s", exponent < 0 ? "&#8315;" : "");
    const int size = exponent < 0 ? -exponent : exponent;
    if (size >= 100)
        fputs(raised[size / 100 % 10], file);
    if (size >= 10)
        fputs(raised[size / 10 % 10], file);
    fputs(raised[size % 10], file);
}

/* What no digits tell. Returns whether it was that. */
static int not_finite(FILE *file, double value)
{
    if (!isfinite(value))
        fputs(isnan(value) ? "&ndash;" : value > 0 ? "&infin;" : "&minus;&infin;", file);
    return !isfinite(value);
}

/* |value| as digits and a power of ten. Returns the power. */
static int scientific(double value, int digits, char text[32])
{
    int exponent = 0;
    snprintf(text, 32, "%.*e", digits - 1, fabs(value));
    sscanf(text, "%*[^e]e%d", &exponent);
    return exponent;
}

/* Powers of ten that are not written apart. */
static int is_short(int exponent, int digits)
{
    return exponent >= -3 && exponent <= digits;
}

/* A number with that many significant digits, a power of ten where it is long. */
static void rounded(FILE *file, double value, int digits)
{
    char text[32];
    if (not_finite(file, value))
        return;
    const int exponent = scientific(value, digits, text);
    if (value < 0)
        fputs("&minus;", file);
    if (is_short(exponent, digits)) {
        fprintf(file, "%.*g", exponent == digits ? digits + 1 : digits, fabs(value));
        return;
    }
    *strchr(text, 'e') = 0;
    fprintf(file, "%.*g", digits, strtod(text, NULL));
    power_of_ten(file, exponent);
}

void html_number(FILE *file, double value)
{
    rounded(file, value, 4);
}

void html_rough(FILE *file, double value)
{
    rounded(file, value, 2);
}

void html_unit(FILE *file, const char *unit)
{
    if (*unit)
        fputs("&nbsp;", file);
    for (; *unit; unit++) {
        const char one[2] = {*unit, 0};
        if (*unit >= '0' && *unit <= '9')
            fputs(raised[*unit - '0'], file);
        else
            html_text(file, one);
    }
}

void html_quantity(FILE *file, double value, const char *unit)
{
    html_number(file, value);
    if (!isnan(value))
        html_unit(file, unit);
}

void html_alike(FILE *file, double value, double most, const char *unit)
{
    char text[64];
    if (not_finite(file, value))
        return;
    const int power = isfinite(most) ? scientific(most, 4, text) : 0, apart = !is_short(power, 4),
              top = apart ? 0 : power;
    const double size = fabs(value) / (apart ? pow(10, power) : 1);
    const int own = size > 0 ? scientific(size, 4, text) : top,
              decimals = 3 - (own < top - 3 ? top - 3 : own);
    int length = snprintf(text, sizeof text, "%.*f", decimals > 0 ? decimals : 0, size);
    if (decimals > 0)
        while (text[length - 1] == '0')
            text[--length] = 0;
    if (text[length - 1] == '.')
        text[length - 1] = 0;
    fprintf(file, "%s%s", value < 0 && strtod(text, NULL) > 0 ? "&minus;" : "", text);
    if (apart)
        power_of_ten(file, power);
    html_unit(file, unit);
}

void html_percent(FILE *file, double share)
{
    rounded(file, 100 * share, 3);
    if (!isnan(share))
        fputs("&nbsp;%", file);
}

/* ---- tables ----------------------------------------------------------- */

void html_table_begin(FILE *file, const char *caption, const char *head)
{
    fputs("<figure class=\"table\">", file);
    if (caption)
        fprintf(file, "<figcaption>%s</figcaption>", caption);
    fputs("<div class=\"wide\" tabindex=\"0\"><table>", file);
    if (head)
        fprintf(file, "<thead><tr>%s</tr></thead>", head);
    fputs("<tbody>\n", file);
}

void html_table_end(FILE *file)
{
    fputs("</tbody></table></div></figure>\n", file);
}

/* ---- colours ---------------------------------------------------------- */

/* Stops of the colour scales, evenly spaced. Lightness is monotone from the middle (signed) or the
 * start (size). */
static const unsigned signed_light[7] = {0x053f77, 0x2f7fbf, 0x9cc8e6, 0xf3f2ef,
                                         0xfbc48a, 0xdf7c27, 0x8c3d04};
static const unsigned signed_dark[7] = {0xb5e2ff, 0x459fe0, 0x1d5683, 0x2a2d33,
                                        0x7c4616, 0xe08028, 0xffd9a8};
static const unsigned viridis[9] = {0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c,
                                    0x28ae80, 0x5ec962, 0xaddc30, 0xfde725};

static unsigned mixed(const unsigned *stop, int stops, double share)
{
    const double place = share * (stops - 1);
    const int below = place >= stops - 1 ? stops - 2 : (int)place;
    unsigned colour = 0;
    for (unsigned shift = 0; shift <= 16; shift += 8) {
        const double low = stop[below] >> shift & 255u, high = stop[below + 1] >> shift & 255u;
        colour |= (unsigned)lround(low + (high - low) * (place - below)) << shift;
    }
    return colour;
}

static void colour_classes(FILE *file, char letter, const unsigned *stop, int stops)
{
    for (int i = 0; i < HTML_LEVELS; i++) {
        const unsigned colour = mixed(stop, stops, (double)i / (HTML_LEVELS - 1));
        fprintf(file, ".%c%d{fill:#%06x;stroke:#%06x}%s", letter, i, colour, colour,
                i % 8 == 7 || i == HTML_LEVELS - 1 ? "\n" : "");
    }
}

/* ---- page ------------------------------------------------------------- */

static const char *const page_style =
    "*{box-sizing:border-box}\n"
    "body{margin:0;background:var(--page);color:var(--ink);font:15px/1.5 system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif}\n"
    "main{max-width:1240px;margin:0 auto;padding:28px 24px 40px}\n"
    "h1{font-size:26px;line-height:1.2;margin:0 0 4px}h2{font-size:19px;margin:34px 0 8px}h3{font-size:16px;margin:0}\n"
    "p{margin:4px 0 12px;max-width:85ch}.soft,figcaption,dt{color:var(--soft)}\n"
    ".kicker{margin:0 0 6px;font-size:13px;letter-spacing:.04em;text-transform:uppercase;color:var(--soft)}\n"
    "dl{display:flex;flex-wrap:wrap;gap:8px 28px;margin:14px 0 0;padding:12px 16px;background:var(--panel);border:1px solid var(--rule);border-radius:8px}\n"
    "dt{font-size:12px}dd{margin:0;font-variant-numeric:tabular-nums}\n"
    ".warn{color:var(--force)}.verdict{font-size:17px;margin:18px 0 0}\n"
    ".wide{overflow-x:auto;background:linear-gradient(270deg,var(--page) 50%,transparent) 100% 0/28px 100% no-repeat local,"
    "linear-gradient(270deg,var(--rule),transparent) 100% 0/14px 100% no-repeat}\n"
    "table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}\n"
    ".table+.table{margin-top:20px}.row>.table{margin-top:0}.table figcaption{margin:0 0 6px;max-width:110ch}th,td{padding:6px 12px 6px 0;border-bottom:1px solid var(--rule);text-align:right;white-space:nowrap}\n"
    "thead th{font-size:12px;font-weight:600;color:var(--soft);vertical-align:bottom}tbody th{font-weight:600}\n"
    "th:first-child,td.word,th.word{text-align:left}td.word,th.word{padding-left:12px}td.note,th.note{text-align:left;white-space:normal}td.note{min-width:190px}\n"
    ".bar{display:inline-block;width:90px;height:9px;margin-left:8px;border-radius:2px;background:var(--rule);vertical-align:middle}\n"
    ".bar i{display:block;height:9px;border-radius:2px;background:var(--accent)}\n"
    ".set{margin:14px 0 0;padding:14px 16px 12px;background:var(--panel);border:1px solid var(--rule);border-radius:8px}\n"
    ".row>*{min-width:0}.row{display:grid;gap:18px;grid-template-columns:1.25fr 1fr 1fr;align-items:start;margin-top:8px}.row.three{grid-template-columns:repeat(3,1fr)}.row.two{grid-template-columns:1fr 1fr}\n"
    "@media (max-width:860px){.row,.row.two,.row.three{grid-template-columns:1fr}}\n"
    "figure{margin:0;min-width:0}figcaption{font-size:13px;line-height:1.4;margin-top:4px}.scale{max-width:340px;margin-top:3px}figcaption b{color:var(--ink);font-weight:600}\n";

static const char *const picture_style =
    "svg{display:block;width:100%;height:auto;overflow:visible}svg text{font:11px system-ui,-apple-system,'Segoe UI',Roboto,Arial,sans-serif;fill:var(--soft);stroke:none}\n"
    ".row svg{max-width:600px}.map svg{max-width:480px}svg .value{font-variant-numeric:tabular-nums;text-anchor:middle}\n"
    ".cells path,.legend path{stroke-width:.6;stroke-linejoin:round}.cells .edge{fill:none;stroke:var(--ink);stroke-opacity:.34;stroke-width:.5}\n"
    ".flat path{stroke:none;shape-rendering:crispEdges}.cells .none,.flat .none{fill:var(--none);stroke:var(--none)}\n"
    ".frame,.grid,.wire,.rest{fill:none;stroke-linejoin:round}.frame{stroke:var(--soft);stroke-width:1}.grid{stroke:var(--ink);stroke-opacity:.16;stroke-width:.5}\n"
    ".wire{stroke:var(--wire);stroke-width:.8;stroke-opacity:.85}.outline{fill:none;stroke:var(--soft);stroke-width:.9;stroke-dasharray:4 3}.rest{stroke:var(--soft);stroke-width:.7;stroke-opacity:.75}\n"
    ".dot{fill:var(--wire);stroke:var(--page);stroke-width:1}svg .tag{fill:var(--ink);font-weight:600;paint-order:stroke;stroke:var(--panel);stroke-width:3px;stroke-linejoin:round}\n"
    ".held,.cells .held{fill:none;stroke:var(--ink);stroke-width:3;stroke-linecap:round;stroke-opacity:.85}.pin{fill:var(--ink)}.body{fill:var(--soft);fill-opacity:.13;stroke:var(--soft);stroke-width:.6;stroke-opacity:.8}\n"
    ".force{fill:var(--force);stroke:var(--force);stroke-width:1.8}.axis{fill:none;stroke:var(--soft);stroke-width:1}\n"
    ".patch{stroke:var(--panel);stroke-width:1}.limit,.beyond{fill:none;stroke:var(--ink);stroke-width:2.2}.beyond{stroke-dasharray:5 3}.limit.strong,.beyond.strong{fill:none;stroke:var(--inverse)}\n"
    "svg text.mild{fill:var(--ink)}svg text.strong{fill:var(--inverse)}.key{display:inline-block;width:22px;height:0;border-top:2px solid var(--wire);vertical-align:middle;margin-right:5px}\n"
    ".best{fill:var(--accent)}.ghost{stroke-opacity:.3}.key.load{border-color:var(--force)}.key.solid{height:11px;border:1px solid var(--soft);background:color-mix(in srgb,var(--soft) 20%,transparent)}.key.dash{border-top:1px dashed var(--soft)}.key.gone{border-color:var(--soft)}.key.stop{width:13px;height:13px;border:2.2px solid var(--ink)}.key.over{width:13px;height:13px;border:2px dashed var(--ink)}.key.hold{border-top-width:4px;border-color:var(--ink)}\n"
    ".keys{margin:0;font-size:13px;color:var(--soft);max-width:none}.keys span{margin-right:18px;white-space:nowrap}\n"
    "@media print{main{max-width:none;padding:0}.set{break-inside:avoid}}\n";

static const char *const light =
    ":root{color-scheme:light dark;--page:#fff;--panel:#f8f8f6;--ink:#1b1f24;--soft:#59626d;--rule:#dcdfe2;--none:#d3d5d8;--accent:#2f7fbf;--wire:#c2187a;--force:#b3261e;--inverse:#fff}\n";
static const char *const dark =
    ":root{--page:#121417;--panel:#1a1d21;--ink:#eceef0;--soft:#a3acb7;--rule:#343a42;--none:#454b54;--accent:#459fe0;--wire:#ff8fcb;--force:#ff8a80;--inverse:#101215}\n";

void html_begin(FILE *file, const char *title)
{
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>",
          file);
    html_text(file, title);
    fprintf(file, "</title>\n<style>\n%s", light);
    colour_classes(file, 's', signed_light, 7);
    colour_classes(file, 'v', viridis, 9);
    fprintf(file, "@media screen and (prefers-color-scheme:dark){\n%s", dark);
    colour_classes(file, 's', signed_dark, 7);
    fprintf(file, "}\n%s%s</style>\n</head>\n<body>\n<main>\n", page_style, picture_style);
}

void html_end(FILE *file)
{
    fputs("</main>\n</body>\n</html>\n", file);
}
