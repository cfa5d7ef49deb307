/* Preloaded into a server of the tests: a disk on which files below a folder `blobs` err in the way that the file named by
   BROKEN_DISK says: `write`, `short` (a half is written, then nothing more) or `fsync`. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

static int errs(int file, const char *fault)
{
    char descriptor[64], path[4096], wanted[16] = "";
    snprintf(descriptor, sizeof descriptor, "/proc/self/fd/%d", file);
    ssize_t length = readlink(descriptor, path, sizeof path - 1);
    if (length < 0)
        return 0;
    path[length] = 0;
    const char *orders = getenv("BROKEN_DISK");
    if (!strstr(path, "/blobs/") || !orders)
        return 0;
    int open_orders = open(orders, O_RDONLY | O_CLOEXEC);
    if (open_orders < 0)
        return 0;
    length = read(open_orders, wanted, sizeof wanted - 1);
    close(open_orders);
    return length > 0 && strcmp(wanted, fault) == 0;
}

ssize_t write(int file, const void *bytes, size_t count)
{
    int is_short = errs(file, "short");
    if (errs(file, "write") || (is_short && lseek(file, 0, SEEK_CUR) > 0)) {
        errno = EIO;
        return -1;
    }
    return syscall(SYS_write, file, bytes, is_short ? count / 2 : count);
}

int fsync(int file)
{
    if (errs(file, "fsync")) {
        errno = EIO;
        return -1;
    }
    return syscall(SYS_fsync, file);
}
