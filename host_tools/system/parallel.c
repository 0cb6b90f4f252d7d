/* SPDX-License-Identifier: BSD-2-Clause */
/* Independent parts of a computation in several threads (parallel.h). */
#define _POSIX_C_SOURCE 200809L
#include "parallel.h"
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

/*
 * Work that several threads share. A thread holds `lock` while it reads or writes the members after
 * it.
 */
typedef struct shared {
    const parallel_work *work;
    int parts;
    pthread_mutex_t lock;
    pthread_cond_t has_run; /* signalled when a thread has finished one part of the work, for the
                               thread that accepts results */
    int next;               /* index of the next part of the work that a thread will begin */
    bool is_ended;          /* true: threads begin no further parts of the work */
    bool *is_done;          /* [parts] whether each part of the work has been computed */
} shared;

int parallel_threads(void)
{
    const char *const text = getenv("PZS_THREADS");
    char *end;
    long threads = 0;
    errno = 0;
    if (text && *text)
        threads = strtol(text, &end, 10);
    if (!text || !*text || *end || errno != 0 || threads < 1)
        threads = sysconf(_SC_NPROCESSORS_ONLN);
    if (threads < 1)
        return 1;
    return threads < PARALLEL_LIMIT ? (int)threads : PARALLEL_LIMIT;
}

/*
 * Run the next part of the shared work. Returns false if no part is left or the work has ended. The
 * caller holds `lock`; the function releases it while the part runs.
 */
static bool run_next(shared *shared)
{
    if (shared->is_ended || shared->next == shared->parts)
        return false;
    const int part = shared->next++;
    pthread_mutex_unlock(&shared->lock);
    shared->work->run(shared->work->context, part);
    pthread_mutex_lock(&shared->lock);
    shared->is_done[part] = true;
    pthread_cond_signal(&shared->has_run);
    return true;
}

static void *run_parts(void *state)
{
    shared *shared = state;
    pthread_mutex_lock(&shared->lock);
    while (run_next(shared))
        continue;
    pthread_mutex_unlock(&shared->lock);
    return NULL;
}

/*
 * Start threads that compute parts of the work. The threads receive no signals. Returns the number
 * of threads that were started, which is less than `wanted` if the system refuses one.
 */
static int start_threads(shared *shared, pthread_t *thread, int wanted)
{
    sigset_t all, before;
    int count = 0;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (count < wanted && pthread_create(&thread[count], NULL, run_parts, shared) == 0)
        count++;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return count;
}

/*
 * Hand the results of all parts of a work to its function `accept` in the order of the parts. While
 * the next result is not ready, run parts of the work in this thread, too, or wait for the other
 * threads.
 */
static void accept_parts(shared *shared)
{
    pthread_mutex_lock(&shared->lock);
    for (int part = 0; part < shared->parts && !shared->is_ended;) {
        if (shared->is_done[part]) {
            pthread_mutex_unlock(&shared->lock);
            const bool goes_on = shared->work->accept(shared->work->context, part++);
            pthread_mutex_lock(&shared->lock);
            shared->is_ended = !goes_on;
        } else if (!run_next(shared))
            pthread_cond_wait(&shared->has_run, &shared->lock);
    }
    pthread_mutex_unlock(&shared->lock);
}

/*
 * Without other threads, run the parts of a work one after the other, and hand each result to the
 * work's function `accept`, until this function ends the work.
 */
static void run_in_turn(const parallel_work *work, int parts)
{
    bool goes_on = true;
    for (int part = 0; part < parts && goes_on; part++) {
        work->run(work->context, part);
        goes_on = work->accept(work->context, part);
    }
}

void parallel_run(const parallel_work *work, int parts)
{
    const int threads = parallel_threads();
    pthread_t thread[PARALLEL_LIMIT];
    shared shared = {.work = work, .parts = parts};
    shared.is_done = calloc((size_t)(parts > 0 ? parts : 1), sizeof *shared.is_done);
    if (threads < 2 || parts < 2 || !shared.is_done) {
        free(shared.is_done);
        run_in_turn(work, parts);
        return;
    }
    pthread_mutex_init(&shared.lock, NULL);
    pthread_cond_init(&shared.has_run, NULL);
    const int others = start_threads(&shared, thread, (threads < parts ? threads : parts) - 1);
    accept_parts(&shared);
    for (int i = 0; i < others; i++)
        pthread_join(thread[i], NULL);
    pthread_cond_destroy(&shared.has_run);
    pthread_mutex_destroy(&shared.lock);
    free(shared.is_done);
}
