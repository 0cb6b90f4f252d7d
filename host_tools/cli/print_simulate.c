/* A simulation in words and numbers (print_simulate.h). */
#include "print_simulate.h"
#include "print.h"
#include "print_vibration.h"
#include "progress.h"
#include "words.h"

static const char *const law_name[LAWS] = {"controller", "clipped", "regularised"};

/* ---- CSV -------------------------------------------------------------- */

static void print_csv_head(FILE *file, const scene *s, int estimates)
{
    fprintf(file, "tick,time,error,active,passes,status,lost%s", estimates ? ",missed" : "");
    for (int k = 0; k < s->amplifiers; k++) {
        char name[SCENE_LABEL];
        scene_amplifier_name(s, k, name);
        fprintf(file, ",%s", name);
    }
    fputc('\n', file);
}

static void print_csv_tick(FILE *file, const scene *s, int estimates, const simulate_sample *sample)
{
    fprintf(file, "%d,%.9g,%.17g,%d,%d,%d,%d", sample->tick, sample->tick / s->simulate.rate,
            sample->error, sample->active, sample->passes, (int)sample->status, sample->lost);
    if (estimates)
        fprintf(file, ",%.17g", sample->missed);
    for (int k = 0; k < s->amplifiers; k++)
        fprintf(file, ",%.17g", sample->volt[k]);
    fputc('\n', file);
}

/* ---- while it runs ---------------------------------------------------- */

typedef struct onlookers {
    const scene *scene;
    simulate_record *record;
    FILE *csv;
    int estimates;
} onlookers;

static void look(void *context, const simulate_sample *sample)
{
    onlookers *w = context;
    record_tick(w->record, sample);
    if (w->csv && sample->law == LAW_CONTROLLER)
        print_csv_tick(w->csv, w->scene, w->estimates, sample);
    progress_count(sample->tick + 1, w->scene->simulate.ticks);
}

int print_run(simulation *s, simulate_record *record, FILE *csv, char *error)
{
    onlookers w = {s->nominal->design.scene, record, csv, s->estimates};
    if (csv)
        print_csv_head(csv, w.scene, s->estimates);
    progress_stage("simulating the controller");
    if (simulate_run(s, LAW_CONTROLLER, look, &w, error) < 0)
        return -1;
    progress_stage("simulating clipped voltages");
    if (simulate_run(s, LAW_CLAMP, look, &w, error) < 0)
        return -1;
    progress_stage("simulating regularised, then clipped voltages");
    if (simulate_run(s, LAW_REGULARISED, look, &w, error) < 0)
        return -1;
    progress_stage("optimum of each phase");
    return simulate_optima(s, error);
}

/* ---- text ------------------------------------------------------------- */

static void print_plant(const simulation *s)
{
    const scene_simulate *simulate = &s->nominal->design.scene->simulate;
    const char *unit = s->nominal->design.scene->unit_length;
    puts("  quasi-static plant: no inertia; each shape is an equilibrium");
    print_certificate(&s->nominal->certificate);
    printf("  plant: %s", s->plant.analysis.nonlinear ? "nonlinear" : "linear");
    for (int i = 0; i < s->plant.scene.materials; i++)
        printf("%s %s stiffness x %g, d x %g", i ? ";" : ",", s->plant.scene.material[i].name,
               simulate->stiffness ? simulate->stiffness[i] : 1, simulate->d ? simulate->d[i] : 1);
    printf("; hysteresis %g\n  sensors: ", simulate->hysteresis);
    if (s->estimates)
        printf("%d, with the noise of their readings", s->estimator.sensors);
    else
        printf("%d, noise %g%s%s", s->nominal->design.targets, simulate->noise, *unit ? " " : "",
               unit);
    printf(", delay %d ticks; amplifiers: steps of %g V, dead band %g V\n", simulate->delay,
           simulate->step, simulate->dead_band);
    printf("  controller: tables of the scene, influence %s; %d ticks at %g a second\n\n",
           simulate->at_target ? "at the nonlinear optimum" : "at rest", simulate->ticks,
           simulate->rate);
}

static void print_settled(const simulate_phase *p)
{
    const simulate_course *c = &p->course[LAW_CONTROLLER];
    if (c->settled < 0)
        printf("%9s", "-");
    else
        printf("%9d", c->settled);
    printf(" %6d", c->slew_ticks);
}

static void print_phases(const simulation *s)
{
    printf("  %-7s %-46s %9s %9s %9s %11s %9s %9s %6s\n", "tick", "phase", "optimum", "steady",
           "clipped", "regularised", "worst", "settled", "slew");
    for (int k = 0; k < s->phases; k++) {
        const simulate_phase *p = &s->phase[k];
        char name[WORDS_PHASE];
        words_phase(s, p, name);
        printf("  %-7d %-46.46s %8.3f%% %8.3f%% %8.3f%% %10.3f%% %8.3f%% ", p->from, name,
               100 * p->optimum, 100 * p->course[LAW_CONTROLLER].steady,
               100 * p->course[LAW_CLAMP].steady, 100 * p->course[LAW_REGULARISED].steady,
               100 * p->course[LAW_CONTROLLER].worst);
        print_settled(p);
        putchar('\n');
    }
    puts(
        "\n  errors of the shape over the scene's target; settled: ticks until within 5% of the way; slew: ticks the slew alone needs");
    puts(
        "  clipped: least squares without limits, cut to limits and slew; regularised: the same with the\n"
        "  one parameter that is best for the scene's target on the controller's model, chosen knowing\n"
        "  the answer");
}

static void print_count(const simulation *s, simulate_law law)
{
    const simulate_count *c = &s->count[law];
    const long run = simulate_ran(c);
    printf(
        "  %-11s %ld volts beyond a limit or the slew, %ld not finite; %ld ticks run, %ld lost, %ld held, %ld with a doubted sensor, "
        "%ld out of passes\n",
        law_name[law], c->beyond, c->not_finite, run, c->lost, c->status[PZS_W_HELD],
        c->status[PZS_W_SENSOR], c->status[PZS_W_ITERATIONS]);
    if (law == LAW_CONTROLLER)
        printf("  %-10s passes of the optimiser: %.2f a tick, %d at most of %d\n", "",
               run ? (double)c->passes / (double)run : 0, c->passes_most, PZS_STEP_ITERATIONS);
}

/* What was estimated, at its worst. */
static void print_estimated(const simulation *s)
{
    const simulate_phase *worst = s->phase;
    if (!s->estimates)
        return;
    for (int k = 1; k < s->phases; k++)
        worst = s->phase[k].course[LAW_CONTROLLER].missed > worst->course[LAW_CONTROLLER].missed
                    ? &s->phase[k]
                    : worst;
    printf(
        "  %-10s %d nodes estimated from %d sensors: off by %.3f%% of the target at the end of the phase from tick %d, less in the "
        "others\n",
        "", s->nominal->design.targets, s->estimator.sensors,
        100 * worst->course[LAW_CONTROLLER].missed, worst->from);
}

static void print_found(const simulation *s)
{
    const simulate_count *c = &s->count[LAW_CONTROLLER];
    if (s->nominal->design.scene->simulate.finds)
        printf(
            "  %-10s electrodes found not to follow: %ld, the slowest after %d ticks; %ld of them in good order\n",
            "", c->found, c->search, c->wrong);
}

static void print_board(const simulation *s)
{
    const simulate_count *c = &s->count[LAW_CONTROLLER];
    if (!s->board)
        return;
    printf("  %-10s the firmware of %s, %s", "", s->board->name,
           s->board->bits == 32 ? "float" : "double");
    if (s->board->twin)
        printf(", under QEMU: %ld of %ld ticks with the bits of the same C on this computer",
               c->same, simulate_ran(c));
    putchar('\n');
}

void print_simulation(const simulation *s)
{
    print_head(s->nominal, words_influence(s->nominal->design.scene));
    print_plant(s);
    print_phases(s);
    print_count(s, LAW_CONTROLLER);
    print_estimated(s);
    print_found(s);
    print_board(s);
    print_count(s, LAW_CLAMP);
    print_count(s, LAW_REGULARISED);
    double seconds = 0;
    for (int law = 0; law < LAWS; law++)
        seconds += s->count[law].seconds;
    printf("  %.2f s, %ld linear systems of the plant\n", seconds, s->plant.systems);
}

/* ---- JSON ------------------------------------------------------------- */

static void json_course(json *j, const simulation *s, const simulate_course *c, simulate_law law)
{
    json_open(j, law_name[law], '{');
    json_number(j, "steady", c->steady);
    json_number(j, "worst", c->worst);
    if (s->estimates)
        json_number(j, "missed", c->missed);
    json_number(j, "settled", c->settled);
    json_number(j, "slew_ticks", c->slew_ticks);
    json_numbers(j, "volts", c->volt, s->nominal->design.amplifiers);
    json_close(j, '}');
}

static void json_phase(json *j, const simulation *s, const simulate_phase *p)
{
    char name[WORDS_PHASE];
    words_phase(s, p, name);
    json_open(j, NULL, '{');
    json_string(j, "phase", name);
    json_number(j, "from", p->from);
    json_number(j, "until", p->until);
    json_number(j, "optimum", p->optimum);
    for (int law = 0; law < LAWS; law++)
        json_course(j, s, &p->course[law], (simulate_law)law);
    json_close(j, '}');
}

static void json_count(json *j, const simulate_count *c, simulate_law law)
{
    json_open(j, law_name[law], '{');
    json_number(j, "beyond", (double)c->beyond);
    json_number(j, "not_finite", (double)c->not_finite);
    json_number(j, "ran", (double)simulate_ran(c));
    json_number(j, "lost", (double)c->lost);
    json_number(j, "held", (double)c->status[PZS_W_HELD]);
    json_number(j, "doubted", (double)c->status[PZS_W_SENSOR]);
    json_number(j, "out_of_passes", (double)c->status[PZS_W_ITERATIONS]);
    json_number(j, "found", (double)c->found);
    json_number(j, "found_wrong", (double)c->wrong);
    json_number(j, "found_ticks", c->search);
    json_number(j, "passes", (double)c->passes);
    json_number(j, "passes_most", c->passes_most);
    json_close(j, '}');
}

void print_simulation_json(const simulation *s)
{
    const scene *scene = s->nominal->design.scene;
    json j = {stdout, 0, {0}};
    json_open(&j, NULL, '{');
    json_string(&j, "scene", scene->name);
    json_string(&j, "plant", s->plant.analysis.nonlinear ? "nonlinear" : "linear");
    json_string(&j, "dynamics", "quasi-static");
    print_certificate_json(&j, &s->nominal->certificate);
    json_number(&j, "ticks", scene->simulate.ticks);
    if (s->board) {
        json_string(&j, "device", s->board->name);
        json_number(&j, "device_bits", s->board->bits);
        json_number(&j, "device_same", (double)s->count[LAW_CONTROLLER].same);
    }
    if (s->estimates)
        print_estimate_json(&j, &s->estimator);
    json_number(&j, "amplifiers", s->nominal->design.amplifiers);
    json_number(&j, "targets", s->nominal->design.targets);
    json_number(&j, "regularisation", s->regularisation);
    json_open(&j, "phases", '[');
    for (int k = 0; k < s->phases; k++)
        json_phase(&j, s, &s->phase[k]);
    json_close(&j, ']');
    json_open(&j, "counts", '{');
    for (int law = 0; law < LAWS; law++)
        json_count(&j, &s->count[law], (simulate_law)law);
    json_close(&j, '}');
    plausible_json(&j, &s->nominal->warnings);
    json_close(&j, '}');
}
