/* SPDX-License-Identifier: BSD-2-Clause */
/* Colours and style sheets of pages and of pictures (report_draw.h), light and dark. */
#include <math.h>
#include <string.h>
#include "report_draw.h"

/* Colours between which a scale is interpolated, with equal distances in the OKLab space. */
enum { STOPS = 9 };
static const unsigned signed_stops[2][STOPS] = {
    {0x113f77, 0x286db0, 0x4f9fe2, 0x9ccdf3, 0xf3f3f3, 0xf4c598, 0xe79044, 0xbe621b, 0x8c3e0f},
    {0x9beaff, 0x63b5e9, 0x3381bc, 0x2f5377, 0x2b2b2b, 0x714223, 0xb1651a, 0xdd9b53, 0xffd48f}};
static const unsigned viridis[STOPS] = {0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c,
                                        0x28ae80, 0x5ec962, 0xaddc30, 0xfde725};

/* Named colours of reports, each for a light and for a dark display. */
static const struct {
    const char *name, *colour[2];
} palette[] = {{"page", {"#fff", "#121417"}},      {"panel", {"#f8f8f6", "#1a1d21"}},
               {"ink", {"#1b1f24", "#eceef0"}},    {"soft", {"#59626d", "#a3acb7"}},
               {"rule", {"#dcdfe2", "#343a42"}},   {"none", {"#d3d5d8", "#454b54"}},
               {"accent", {"#2f7fbf", "#459fe0"}}, {"wire", {"#c2187a", "#ff8fcb"}},
               {"force", {"#b3261e", "#ff8a80"}},  {"inverse", {"#fff", "#101215"}}};
enum { COLOURS = sizeof palette / sizeof *palette };

#define FONT "system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif"

static const char page_style[] =
    "*{box-sizing:border-box}body{margin:0;background:var(--page);color:var(--ink);"
    "font:15px/1.5  " FONT "}main{max-width:1240px;margin:0 auto;padding:28px 24px "
    "40px}h1{font-size:26px;line-height:1.2;margin:0 0 4px}h2{font-size:19px;margin:34px 0 8px}"
    "h3{font-size:16px;margin:0}p{margin:4px 0 12px;max-width:85ch}.soft,figcaption,dt,footer,"
    "summary{color:var(--soft)}code{overflow-wrap:anywhere}.kicker{margin:0 0 6px;"
    "font-size:13px;letter-spacing:.04em;text-transform:uppercase;color:var(--soft)}dl{"
    "display:flex;flex-wrap:wrap;gap:8px 28px;margin:14px 0 0;padding:12px 16px}dl,.set{"
    "background:var(--panel);border:1px solid var(--rule);border-radius:8px}dt{font-size:12px}"
    "dd{margin:0;font-variant-numeric:tabular-nums}.warn{color:var(--force)}.verdict{"
    "font-size:17px;margin:18px 0 0}.wide{overflow-x:auto}table{border-collapse:collapse;"
    "width:100%;font-variant-numeric:tabular-nums}.table+.table{margin-top:20px}.row>.table{"
    "margin-top:0}.table figcaption{margin:0 0 6px;max-width:110ch}th,td{padding:6px 12px 6px "
    "0;border-bottom:1px solid var(--rule);text-align:right;white-space:nowrap}thead th{"
    "font-size:12px;color:var(--soft);vertical-align:bottom}th{font-weight:600}th:first-child,"
    ".word,.note{text-align:left}td.word,th.word{padding-left:12px}td.note{white-space:normal;"
    "min-width:190px}details{margin-top:14px}summary{cursor:pointer}footer{margin-top:34px;"
    "padding-top:10px;border-top:1px solid var(--rule);font-size:13px}.bar{"
    "display:inline-block;width:90px;margin-left:8px;background:var(--rule);"
    "vertical-align:middle}.bar,.bar i{height:9px;border-radius:2px}.bar i{display:block;"
    "background:var(--accent)}.set{margin:14px 0 0;padding:14px 16px 12px}.row>*{min-width:0}"
    ".row{display:grid;gap:18px;grid-template-columns:repeat(auto-fit,minmax(300px,1fr));"
    "align-items:start;margin-top:8px}figure{margin:0;min-width:0}figcaption{font-size:13px;"
    "line-height:1.4;margin-top:4px}figcaption b{color:var(--ink);font-weight:600}.scale{"
    "max-width:340px;margin-top:3px}.keys{margin:0;font-size:13px;color:var(--soft);"
    "max-width:none}.keys span{margin-right:18px;white-space:nowrap}.key{display:inline-block;"
    "width:22px;height:0;border-top:2px solid var(--wire);vertical-align:middle;"
    "margin-right:5px}.key.load{border-color:var(--force)}.key.solid{height:11px;border:1px "
    "solid var(--soft);background:var(--rule)}.key.dash{border-top:1px dashed var(--soft)}"
    ".key.gone{border-color:var(--soft)}.key.stop,.key.over{width:13px;height:13px;border:2px "
    "solid var(--ink)}.key.over{border-style:dashed}.key.pins{width:7px;height:7px;border:0;"
    "border-radius:4px;background:var(--ink)}.chart{max-width:760px}pre{overflow-x:auto;"
    "font-size:12px}svg{display:block;width:100%;height:auto}.row svg{max-width:600px}.map svg{"
    "max-width:480px}details+.table{margin-top:20px}@media print{main{max-width:none;padding:0}"
    ".set{break-inside:avoid}}.lines{white-space:pre-line}";

static const char picture_style[] =
    "svg{overflow:visible}svg text{font:11px " FONT ";fill:var(--soft);stroke:none}"
    "svg .value{font-variant-numeric:tabular-nums;text-anchor:middle}svg .end{text-anchor:end}"
    "svg .title{font-size:17px;font-weight:600;fill:var(--ink)}.back{fill:var(--panel);"
    "stroke:var(--rule)}.cells path{stroke-width:.6;stroke-linejoin:round}.flat path{"
    "stroke:none;shape-rendering:crispEdges}.cells .edge{fill:none;stroke:var(--ink);"
    "stroke-opacity:.34;stroke-width:.5}.cells .none,.flat .none,.none{fill:var(--none);"
    "stroke:var(--none)}.frame,.grid,.wire,.rest,.flat .at{fill:none;stroke-linejoin:round}"
    ".frame{stroke:var(--soft);stroke-width:1}.grid{stroke:var(--ink);stroke-opacity:.16;"
    "stroke-width:.5}.flat .at{stroke:var(--ink);stroke-width:1}.wire{stroke:var(--wire);"
    "stroke-width:.8;stroke-opacity:.85}.bold{stroke-width:1.6}.outline{fill:none;"
    "stroke:var(--soft);stroke-width:.9;stroke-dasharray:4 3}.rest{stroke:var(--soft);"
    "stroke-width:.7;stroke-opacity:.75}.rest.bold{stroke-width:1.6}.ghost{stroke-opacity:.3}"
    ".dot{fill:var(--wire);stroke:var(--page);stroke-width:1}svg .tag{fill:var(--ink);"
    "font-weight:600;paint-order:stroke;stroke:var(--panel);stroke-width:3px;"
    "stroke-linejoin:round}.pin{fill:var(--ink)}.body{fill:var(--soft);fill-opacity:.13;"
    "stroke:var(--soft);stroke-width:.6}.force{fill:var(--force);stroke:var(--force);"
    "stroke-width:1.8}.axis{fill:none;stroke:var(--soft)}.patch{fill:none;stroke:var(--none);"
    "stroke-width:1}.limit,.beyond{fill:none;stroke:var(--ink);stroke-width:2.2}.beyond{"
    "stroke-dasharray:5 3}.limit.strong,.beyond.strong{stroke:var(--inverse)}svg text.mild{"
    "fill:var(--ink)}svg text.strong{fill:var(--inverse)}";

static unsigned mixed(const unsigned stop[STOPS], double share)
{
    const double place = share * (STOPS - 1);
    const int below = place >= STOPS - 1 ? STOPS - 2 : (int)place;
    unsigned colour = 0;
    for (unsigned shift = 0; shift <= 16; shift += 8) {
        const double low = stop[below] >> shift & 255u, high = stop[below + 1] >> shift & 255u;
        colour |= (unsigned)lround(low + (high - low) * (place - below)) << shift;
    }
    return colour;
}

static void write_levels(FILE *file, char letter, const unsigned stop[STOPS])
{
    for (int i = 0; i < DRAW_LEVELS; i++) {
        const unsigned colour = mixed(stop, (double)i / (DRAW_LEVELS - 1));
        fprintf(file, ".%c%d{fill:#%06x;stroke:#%06x}%s", letter, i, colour, colour,
                i % 8 ? "" : "\n");
    }
}

static void write_variables(FILE *file, int is_dark)
{
    fputs(":root{", file);
    for (int k = 0; k < COLOURS; k++)
        fprintf(file, "--%s:%s;", palette[k].name, palette[k].colour[is_dark]);
    fputs("}\n", file);
}

/* Write a style rule without CSS variables, which many SVG viewers do not know. */
static void write_expanded(FILE *file, const char *rule, int is_dark)
{
    const char *at;
    while ((at = strstr(rule, "var(--")) != NULL) {
        int k = 0;
        fprintf(file, "%.*s", (int)(at - rule), rule);
        at += strlen("var(--");
        while (k < COLOURS - 1 && strncmp(at, palette[k].name, strcspn(at, ")")) != 0)
            k++;
        fputs(palette[k].colour[is_dark], file);
        rule = strchr(at, ')') + 1;
    }
    fputs(rule, file);
}

void draw_style(FILE *file, bool is_page)
{
    fputs(is_page ? "<style>\n:root{color-scheme:light dark}" : "<style>\n", file);
    write_levels(file, 'v', viridis);
    for (int is_dark = 0; is_dark < 2; is_dark++) {
        fputs(is_dark ? "@media screen and (prefers-color-scheme:dark){" : "", file);
        write_levels(file, 's', signed_stops[is_dark]);
        if (is_page)
            write_variables(file, is_dark);
        else
            write_expanded(file, picture_style, is_dark);
        fputs(is_dark ? "}\n" : "", file);
    }
    if (is_page)
        fprintf(file, "%s%s", page_style, picture_style);
    fputs("</style>\n", file);
}
