/* SPDX-License-Identifier: BSD-2-Clause */
/* Scenes shipped with the program (shipped.h). */
#define _POSIX_C_SOURCE 200809L
#include "shipped.h"
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char ending[] = ".yaml";

/*
 * Find a file or folder of the installation.
 *   inside in   path relative to the folder above that of this program
 *   path   out  full path
 * Returns whether the file or folder exists.
 */
static int beside_program(const char *inside, char path[SHIPPED_PATH])
{
    char program[SHIPPED_PATH];
    struct stat there;
    const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length <= 0)
        return 0;
    program[length] = '\0';
    for (int up = 0; up < 2; up++) {
        char *slash = strrchr(program, '/');
        if (!slash)
            return 0;
        *slash = '\0';
    }
    return snprintf(path, SHIPPED_PATH, "%s/%s", program, inside) < SHIPPED_PATH &&
           stat(path, &there) == 0;
}

const char *shipped_folder(void)
{
    static char path[SHIPPED_PATH];
    const char *folder = getenv("PZS_SCENES");
    if (folder && *folder)
        return folder;
    if (beside_program("share/piezoshape/scenes", path) || beside_program(SCENE_PLACE, path))
        return path;
    return SCENE_FOLDER;
}

const char *shipped_sources(void)
{
    static char path[SHIPPED_PATH];
    const char *folder = getenv("PZS_SOURCES");
    if (folder && *folder)
        return folder;
    if (beside_program("firmware_demo/firmware.mk", path) && beside_program("", path))
        return path;
    return SOURCE_FOLDER;
}

static int is_scene_file(const char *name)
{
    const size_t length = strlen(name);
    return length >= sizeof ending && strcmp(name + length + 1 - sizeof ending, ending) == 0;
}

int shipped_is_name(const char *name)
{
    return !strchr(name, '/') && !is_scene_file(name);
}

/*
 * If a file lies below the current folder, replace its path by the path relative to the current
 * folder, which is shorter in error messages.
 */
static void shorten(char path[SHIPPED_PATH])
{
    char here[SHIPPED_PATH];
    if (!getcwd(here, sizeof here))
        return;
    const size_t length = strlen(here);
    if (strncmp(path, here, length) == 0 && path[length] == '/')
        memmove(path, path + length + 1, strlen(path + length));
}

void shipped_path(const char *name, char path[SHIPPED_PATH])
{
    snprintf(path, SHIPPED_PATH, "%s", name);
    if (!shipped_is_name(name))
        return;
    snprintf(path, SHIPPED_PATH, "%s/%s%s", shipped_folder(), name, ending);
    shorten(path);
}

static int is_scene(const struct dirent *entry)
{
    return is_scene_file(entry->d_name);
}

int shipped_each(shipped_visit *visit, void *context)
{
    struct dirent **entry;
    const int count = scandir(shipped_folder(), &entry, is_scene, alphasort);
    int sum = 0;
    if (count < 0)
        return -1;
    for (int i = 0; i < count; i++) {
        entry[i]->d_name[strlen(entry[i]->d_name) + 1 - sizeof ending] = '\0';
        sum += visit(context, entry[i]->d_name);
        free(entry[i]);
    }
    free(entry);
    return sum;
}

static int consider(void *context, const char *name)
{
    suggest_consider(context, name);
    return 0;
}

void shipped_suggest(suggestion *suggestion, const char *name)
{
    suggest_begin(suggestion, name);
    (void)shipped_each(consider, suggestion);
}
