/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Progress display on a terminal (progress.h). The timer's signal handler calls only functions that
 * POSIX permits in a signal handler.
 */
#define _XOPEN_SOURCE 700
#include "progress.h"
#include <errno.h>
#include <signal.h>
#include <stddef.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

enum {
    QUIET_SECONDS = 2,
    INTERVAL = 500000 /* period of the timer that updates the progress display (microseconds) */,
    LINE = 160,
    DIGITS = 20
};

static const char *volatile stage = "";
static const uint32_t *volatile solves;
static volatile sig_atomic_t done, total, is_running, is_shown;
static struct timespec began;

/*
 * Text of the progress display and its length, used to compose the displayed line piece by piece.
 */
typedef struct text {
    char at[LINE];
    size_t length;
} text;

static void put(text *line, const char *word)
{
    while (*word && line->length < LINE)
        line->at[line->length++] = *word++;
}

static void put_number(text *line, long value)
{
    char digits[DIGITS + 1];
    int at = DIGITS;
    digits[at] = '\0';
    do {
        digits[--at] = (char)('0' + value % 10);
        value /= 10;
    } while (value > 0 && at > 0);
    put(line, digits + at);
}

/* Return the time since the call of progress_start (whole seconds). */
static long seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (long)(now.tv_sec - began.tv_sec) - (now.tv_nsec < began.tv_nsec);
}

static void show(text *line)
{
    put(line, "\rpzs: ");
    put(line, stage);
    if (total > 0) {
        put(line, ", ");
        put_number(line, done);
        put(line, " of ");
        put_number(line, total);
    }
    if (solves) {
        put(line, ", ");
        put_number(line, (long)*solves);
        put(line, " linear solves");
    }
    put(line, ", ");
    put_number(line, seconds());
    put(line, " s\033[K");
}

static void tell(int signal_number)
{
    const int kept = errno;
    text line = {"", 0};
    (void)signal_number;
    if (is_running && seconds() >= QUIET_SECONDS) {
        show(&line);
        is_shown = write(2, line.at, line.length) > 0;
    }
    errno = kept;
}

void progress_start(void)
{
    const struct itimerval every = {{0, INTERVAL}, {0, INTERVAL}};
    struct sigaction action;
    if (!isatty(2))
        return;
    memset(&action, 0, sizeof action);
    action.sa_handler = tell;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    clock_gettime(CLOCK_MONOTONIC, &began);
    is_running =
        sigaction(SIGALRM, &action, NULL) == 0 && setitimer(ITIMER_REAL, &every, NULL) == 0;
}

void progress_stage(const char *what)
{
    solves = NULL;
    total = 0;
    stage = what;
}

void progress_count(int parts, int of)
{
    done = parts;
    total = of;
}

void progress_solves(const uint32_t *counter)
{
    solves = counter;
}

void progress_stop(void)
{
    static const char wipe[] = "\r\033[K";
    const struct itimerval never = {{0, 0}, {0, 0}};
    if (!is_running)
        return;
    is_running = 0;
    setitimer(ITIMER_REAL, &never, NULL);
    if (is_shown)
        is_shown = write(2, wipe, sizeof wipe - 1) < 0;
}
