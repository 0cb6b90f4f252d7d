/* SPDX-License-Identifier: BSD-2-Clause */
/* Reactions of the supports on standard output (print_reactions.h). */
#include "print_reactions.h"
#include <stdio.h>
#include "../text/words.h"

/* ---- text ------------------------------------------------------------- */

static void print_row(const char *name, const total_force *total)
{
    printf("  %-20.20s", name);
    for (int i = 0; i < 3; i++)
        printf(" %13.6e", total->force[i]);
    for (int i = 0; i < 3; i++)
        printf(" %13.6e", total->moment[i]);
    putchar('\n');
}

static void print_supports(const reactions *reactions)
{
    for (int k = 0; k < reactions->supports; k++)
        print_row(reactions->support[k].name, &reactions->support[k].total);
}

static void print_balance(const analysis *analysis)
{
    const reactions *reactions = &analysis->reactions;
    puts("\n  moments about the origin");
    print_row("all supports", &reactions->held);
    print_row("loads", &reactions->load);
    if (analysis->design.mesh.springs.count > 0)
        print_row("springs", &reactions->spring);
    if (analysis->design.contact.given)
        print_row("contact", &reactions->contact);
    print_row("sum", &reactions->sum);
    if (!analysis->design.mesh.formulation.cartesian)
        puts("  element: published strains under rigid motion on a curved shell, so that the sum "
             "vanishes\n  with the size of the elements alone; element: improved balances exactly");
}

void print_reactions(const analysis *analysis)
{
    const design *design = &analysis->design;
    const reactions *reactions = &analysis->reactions;
    char unit[WORDS_UNIT], moment[WORDS_UNIT];
    if (design->supports == 0)
        return;
    if (reactions->nodes == 0) {
        printf("\n  reactions: not computed, %d nodes of %u dof are more than 65534 dof\n",
               design->mesh.nodes, design->mesh.dof_per_node);
        return;
    }
    words_unit(&design->units, QUANTITY_FORCE, unit);
    words_unit(&design->units, QUANTITY_MOMENT, moment);
    printf("\n  %-20s %13s %13s %13s %13s %13s %13s\n", "force of supports", "force x", "y", "z",
           "moment x", "y", "z");
    print_supports(reactions);
    print_balance(analysis);
    if (*unit)
        printf("  forces in %s; moments in %s, those of a support about the mean of its nodes%s\n",
               unit, moment, analysis->is_nonlinear ? ", of the deformed shell" : "");
}

/* ---- JSON ------------------------------------------------------------- */

static void json_total(json *json, const char *key, const total_force *total)
{
    json_open(json, key, '{');
    json_numbers(json, "force", total->force, 3);
    json_numbers(json, "moment", total->moment, 3);
    json_close(json, '}');
}

static void json_support(json *json, const support_reaction *support)
{
    json_open(json, NULL, '{');
    json_string(json, "support", support->name);
    json_number(json, "nodes", support->nodes);
    json_numbers(json, "centre", support->centre, 3);
    json_numbers(json, "force", support->total.force, 3);
    json_numbers(json, "moment", support->total.moment, 3);
    json_close(json, '}');
}

void print_reactions_json(json *json, const analysis *analysis)
{
    const reactions *reactions = &analysis->reactions;
    if (reactions->nodes == 0)
        return;
    json_open(json, "reactions", '{');
    json_open(json, "supports", '[');
    for (int k = 0; k < reactions->supports; k++)
        json_support(json, &reactions->support[k]);
    json_close(json, ']');
    json_total(json, "held", &reactions->held);
    json_total(json, "loads", &reactions->load);
    json_total(json, "springs", &reactions->spring);
    json_total(json, "contact", &reactions->contact);
    json_total(json, "sum", &reactions->sum);
    json_number(json, "internal", reactions->internal);
    json_close(json, '}');
}
