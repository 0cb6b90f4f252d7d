/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Texts that describe an FMU: modelDescription.xml, generated C files, documentation (fmu_parts.h).
 */
#include "fmu_parts.h"
#include <math.h>
#include <string.h>
#include "../../include/pzs.h"
#include "../report/report_put.h"
#include "../scene/units.h"
#include "../tables/emit.h"

static const char *const kind_name[] = {[FMU_PLANT] = "plant", [FMU_CONTROLLER] = "controller"};

/* ---- units ------------------------------------------------------------ */

/*
 * Return whether one of the variables before variable `index` of the FMU has the same unit as this
 * variable, so that the unit is already defined.
 */
static bool is_defined(const fmu *fmu, int index)
{
    for (int i = 0; i < index; i++)
        if (strcmp(fmu->variable[i].unit, fmu->variable[index].unit) == 0)
            return true;
    return false;
}

/*
 * Write the XML definition of a unit, with the exponents of the SI base units in it, if pzs knows
 * the unit.
 */
static void put_unit_definition(FILE *file, const char *text)
{
    units_unit unit;
    const char *why;
    put(file, "    <Unit name=\"%t\"", text);
    if (units_parse(text, &unit, &why) < 0 || unit.degrees != 0) {
        fputs("/>\n", file);
        return;
    }
    const int force = unit.power[UNITS_FORCE], voltage = unit.power[UNITS_VOLTAGE];
    const struct {
        const char *name;
        int power;
    } base[] = {{"kg", force + voltage},
                {"m", unit.power[UNITS_LENGTH] + force + 2 * voltage},
                {"s", unit.power[UNITS_TIME] - 2 * force - 3 * voltage},
                {"A", -voltage},
                {"K", unit.power[UNITS_TEMPERATURE]},
                {"rad", unit.power[UNITS_ANGLE]}};
    fputs("><BaseUnit", file);
    for (size_t i = 0; i < sizeof base / sizeof *base; i++)
        if (base[i].power != 0)
            fprintf(file, " %s=\"%d\"", base[i].name, base[i].power);
    if (unit.ten != 0)
        fprintf(file, " factor=\"1e%d\"", unit.ten);
    fputs("/></Unit>\n", file);
}

static void put_units(const fmu *fmu, FILE *file)
{
    int defined = 0;
    for (int i = 0; i < fmu->variables; i++) {
        if (!fmu->variable[i].unit[0] || is_defined(fmu, i))
            continue;
        fputs(defined++ == 0 ? "  <UnitDefinitions>\n" : "", file);
        put_unit_definition(file, fmu->variable[i].unit);
    }
    fputs(defined > 0 ? "  </UnitDefinitions>\n" : "", file);
}

/* ---- modelDescription.xml --------------------------------------------- */

static void put_head(const fmu *fmu, FILE *file)
{
    put(file,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"%t %s\" guid=\"%t\"\n"
        "    description=\"%t\"\n"
        "    generationTool=\"pzs %s\" variableNamingConvention=\"flat\" "
        "numberOfEventIndicators=\"0\">\n"
        "  <CoSimulation modelIdentifier=\"%s\" canHandleVariableCommunicationStepSize=\"false\"\n"
        "      canBeInstantiatedOnlyOncePerProcess=\"false\" "
        "canNotUseMemoryManagementFunctions=\"true\"\n"
        "      canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"false\">\n"
        "    <SourceFiles>\n",
        fmu->design->name, kind_name[fmu->kind], fmu->guid,
        fmu->design->about ? fmu->design->about : "", PZS_VERSION_TEXT, fmu->identifier);
    for (int i = 0; i < fmu->files; i++) {
        const char *name = fmu->file[i].name;
        if (strcmp(name + strlen(name) - 2, ".c") == 0)
            fprintf(file, "      <File name=\"%s\"/>\n", name);
    }
    fputs("    </SourceFiles>\n  </CoSimulation>\n", file);
}

static void put_variable(const fmu_variable *variable, int reference, FILE *file)
{
    static const char *const type[] = {"Real", "Integer", "String"};
    static const char *const role[] = {
        [FMU_INPUT] = "causality=\"input\" variability=\"discrete\"",
        [FMU_PARAMETER] = "causality=\"parameter\" variability=\"fixed\" initial=\"exact\"",
        [FMU_OUTPUT] = "causality=\"output\" variability=\"discrete\" initial=\"calculated\""};
    put(file,
        "    <ScalarVariable name=\"%t\" valueReference=\"%d\" %s\n        description=\"%t\">",
        variable->name, reference, role[variable->role], variable->about);
    fprintf(file, "<%s", type[variable->type]);
    if (variable->role != FMU_OUTPUT)
        fprintf(file, " start=\"%.17g\"", variable->start);
    if (variable->unit[0])
        put(file, " unit=\"%t\"", variable->unit);
    fputs("/></ScalarVariable>\n", file);
}

/*
 * Write an XML list of all output variables, each by its number among all variables, counted
 * from 1.
 */
static void put_outputs(const fmu *fmu, const char *name, const char *attributes, FILE *file)
{
    fprintf(file, "    <%s>\n", name);
    for (int i = 0; i < fmu->variables; i++)
        if (fmu->variable[i].role == FMU_OUTPUT)
            fprintf(file, "      <Unknown index=\"%d\"%s/>\n", i + 1, attributes);
    fprintf(file, "    </%s>\n", name);
}

void fmu_write_description(const fmu *fmu, FILE *file)
{
    int reference[FMU_TYPES] = {0};
    const double period = 1 / fmu->design->control.rate;
    put_head(fmu, file);
    put_units(fmu, file);
    fprintf(file,
            "  <LogCategories>\n    <Category name=\"logStatusWarning\"/>\n"
            "    <Category name=\"logStatusError\"/>\n  </LogCategories>\n"
            "  <DefaultExperiment startTime=\"0\" stopTime=\"%.17g\" stepSize=\"%.17g\"/>\n"
            "  <ModelVariables>\n",
            fmu->design->simulate.ticks > 0 ? fmu->design->simulate.ticks * period : 1.0, period);
    for (int i = 0; i < fmu->variables; i++)
        put_variable(&fmu->variable[i], reference[fmu->variable[i].type]++, file);
    fputs("  </ModelVariables>\n  <ModelStructure>\n", file);
    put_outputs(fmu, "Outputs", " dependencies=\"\"", file);
    put_outputs(fmu, "InitialUnknowns", "", file);
    fputs("  </ModelStructure>\n</fmiModelDescription>\n", file);
}

/* ---- generated C files ------------------------------------------------ */

/*
 * Write C macros with the number of variables of a type, and with the number of those variables
 * that a simulator may set.
 */
static void write_counts(const fmu *fmu, fmu_type type, const char *name, FILE *file)
{
    const int count = fmu_count(fmu, type);
    fprintf(file, "#define FMU_%sS_USED %d\n#define FMU_%sS %d\n#define FMU_%s_INPUTS %d\n", name,
            count, name, count > 0 ? count : 1, name, fmu_count_settable(fmu, type));
}

void fmu_write_about(fmu *fmu)
{
    FILE *file = fmu_begin_file(fmu, "fmu_about.h");
    if (!file)
        return;
    fprintf(
        file,
        "/* Numbers of variables of this FMU (functional mock-up unit). Generated by `pzs fmu`; do "
        "not edit. */\n"
        "#ifndef FMU_ABOUT_H\n#define FMU_ABOUT_H\n\n#define FMU_GUID \"%s\"\n"
        "/* period of a control tick (s) */\n#define FMU_PERIOD (1.0 / %.17g)\n"
        "/* for one type of variables: number of variables; size of the array that holds them; "
        "number of inputs and parameters, which the simulator sets */\n",
        fmu->guid, fmu->design->control.rate);
    write_counts(fmu, FMU_REAL, "REAL", file);
    write_counts(fmu, FMU_INTEGER, "INTEGER", file);
    write_counts(fmu, FMU_STRING, "STRING", file);
    fputs("\n#endif\n", file);
    fmu_end_file(fmu);
}

/* Write a text as a C string literal. */
static void write_string(const char *text, FILE *file)
{
    fputc('"', file);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\')
            fputc('\\', file);
        fputc((unsigned char)*text < ' ' ? ' ' : *text, file);
    }
    fputc('"', file);
}

void fmu_write_variables(fmu *fmu)
{
    FILE *file = fmu_begin_file(fmu, "fmu_variables.c");
    if (!file)
        return;
    fputs("/* Start values and names of the variables of this FMU (functional mock-up unit). "
          "Generated by `pzs fmu`; do not edit. */\n"
          "#include \"fmu_model.h\"\n\nconst fmi2Real fmu_real_start[FMU_REALS] = {0",
          file);
    int written = 0;
    for (int i = 0; i < fmu->variables; i++)
        if (fmu->variable[i].type == FMU_REAL)
            fprintf(file, written++ ? ",\n    %.17g" : "\n    + %.17g", fmu->variable[i].start);
    fputs("};\n\nconst fmi2Integer fmu_integer_start[FMU_INTEGERS] = {0", file);
    written = 0;
    for (int i = 0; i < fmu->variables; i++)
        if (fmu->variable[i].type == FMU_INTEGER)
            fprintf(file, written++ ? ", %.0f" : " + %.0f", fmu->variable[i].start);
    fputs("};\n\nconst char *const fmu_real_name[FMU_REALS] = {\n", file);
    for (int i = 0; i < fmu->variables; i++) {
        if (fmu->variable[i].type != FMU_REAL)
            continue;
        fputs("    ", file);
        write_string(fmu->variable[i].name, file);
        fputs(",\n", file);
    }
    fputs("};\n", file);
    fmu_end_file(fmu);
}

/* ---- documentation ---------------------------------------------------- */

static const char *const text_of_plant =
    "<p>The plant of <code>pzs simulate</code>: amplifiers, cables, ceramic, linear structure with "
    "or without vibration, sensors with noise. A step is one tick of the controller. The commands "
    "<code>voltage.*</code> act from the beginning of the step. The loads <code>load.*</code> are "
    "factors of the loads of the scene; a load that is set before a step acts from its end. After "
    "the step, <code>reading.*</code> are the readings for the next tick, <code>shape.*</code> the "
    "true displacements, <code>amplifier.*</code> the output voltages. The parameter "
    "<code>seed</code> chooses the noise.</p>";

static const char *const text_of_controller =
    "<p>The control loop of the library with the tables of <code>pzs tables</code>. A step is one "
    "tick: set <code>target.*</code> and <code>reading.*</code> (NaN: the sensor gives nothing), "
    "do the step, get <code>voltage.*</code>. <code>status</code> is a value of "
    "<code>pzs_status</code>, 0 if all is well; <code>status_text</code> says the same in words. "
    "<code>load_now.*</code> and <code>load_next.*</code>, if there are any, are known loads at "
    "the time of the readings and under the next voltages. A supervisor (<code>safety</code>) adds "
    "the input <code>command</code> (a value of <code>pzs_supervisor_command</code>) and the "
    "output <code>mode</code>.</p>";

static const char *const text_of_loop =
    "<h2>Closing the loop</h2>\n<p>In each tick: copy the readings of the plant to the controller, "
    "step the controller, copy its voltages to the plant, step the plant. In this order the loop "
    "has the same bits as <code>pzs simulate</code>. A tool that steps both FMUs at once gives the "
    "plant voltages that are one tick late: export the controller with "
    "<code>--set simulate.sensors.delay=N</code>, N one more than in the scene of the plant.</p>";

void fmu_write_page(const fmu *fmu, FILE *file)
{
    const char *text = fmu->kind == FMU_PLANT ? text_of_plant : text_of_controller;
    put(file,
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/><title>%t %s</title>"
        "</head><body>\n<h1>%t: %s</h1>\n<p>%t</p>\n%s\n",
        fmu->design->name, kind_name[fmu->kind], fmu->design->name, kind_name[fmu->kind],
        fmu->design->about ? fmu->design->about : "", text);
    fprintf(file, "<p>Every step has the length of a tick, %.9g s; other steps are refused.</p>\n",
            1 / fmu->design->control.rate);
    fprintf(file,
            "%s\n<h2>Compiling</h2>\n<p>The folder <code>sources</code> is complete: compile all "
            "of its .c files as C99 with <code>-ffp-contract=off</code> and this folder as include "
            "path, to a shared library. Licence: BSD 2-Clause, in "
            "<code>documentation/licenses</code>.</p>\n</body></html>\n",
            text_of_loop);
}
