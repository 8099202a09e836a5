/* TetGen in a process of its own: version 1.5 crashes where it finds that a surface crosses itself, and what it would
   take with it are all ranks. */
#ifdef EQM_HAVE_TETGEN
#include "prepare/tetgen.h"
#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

static int WriteAll(int pipe, const void *bytes, size_t count)
{
  const char *from = bytes;

  while (count) {
    const ssize_t written = write(pipe, from, count);

    if (written < 0 && errno != EINTR) return 1;
    if (written < 0) continue;
    from += written;
    count -= (size_t)written;
  }
  return 0;
}

/* False: the other end is closed too soon. */
static int ReadAll(int pipe, void *bytes, size_t count)
{
  char *to = bytes;

  while (count) {
    const ssize_t got = read(pipe, to, count);

    if (got == 0 || (got < 0 && errno != EINTR)) return 0;
    if (got < 0) continue;
    to += got;
    count -= (size_t)got;
  }
  return 1;
}

/* The child: a crash ends it as such, without the handlers of the program and of MPI, and so does its end. */
static void RunChild(int pipe, const char *switches, int num_vertices, const double *vertices, int num_triangles,
                     const int *triangles)
{
  static const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGINT};
  int head[3], *corners, wrong;
  double *points;

  for (size_t k = 0; k < sizeof(signals) / sizeof(signals[0]); k++) (void)signal(signals[k], SIG_DFL);
  (void)close(STDERR_FILENO); /* what the C library says of a crash */
  head[0] =
      EqmTetgenRun(switches, num_vertices, vertices, num_triangles, triangles, &head[1], &points, &head[2], &corners);
  wrong = WriteAll(pipe, head, sizeof(head));
  if (!wrong && !head[0]) wrong = WriteAll(pipe, points, 3 * sizeof(double) * (size_t)head[1]);
  if (!wrong && !head[0]) wrong = WriteAll(pipe, corners, 4 * sizeof(int) * (size_t)head[2]);
  _exit(wrong);
}

/* What the child sends. */
static int Receive(int pipe, int *num_points, double **points, int *num_cells, int **corners)
{
  int head[3];

  if (!ReadAll(pipe, head, sizeof(head))) return EQM_TETGEN_CRASHED;
  if (head[0]) return head[0];
  *num_points = head[1];
  *num_cells = head[2];
  *points = malloc(3 * sizeof(double) * (size_t)head[1] + 1);
  *corners = malloc(4 * sizeof(int) * (size_t)head[2] + 1);
  if (!*points || !*corners) return EQM_TETGEN_NO_MEMORY;
  return ReadAll(pipe, *points, 3 * sizeof(double) * (size_t)head[1]) &&
                 ReadAll(pipe, *corners, 4 * sizeof(int) * (size_t)head[2])
             ? 0
             : EQM_TETGEN_CRASHED;
}

int EqmTetgenApart(const char *switches, int num_vertices, const double *vertices, int num_triangles,
                   const int *triangles, int *num_points, double **points, int *num_cells, int **corners)
{
  int ends[2], outcome;
  pid_t child;

  *num_points = *num_cells = 0;
  *points = NULL;
  *corners = NULL;
  if (pipe(ends)) return EQM_TETGEN_NO_MEMORY;
  child = fork();
  if (child == 0) {
    (void)close(ends[0]);
    RunChild(ends[1], switches, num_vertices, vertices, num_triangles, triangles);
  }
  (void)close(ends[1]);
  outcome = child < 0 ? EQM_TETGEN_NO_MEMORY : Receive(ends[0], num_points, points, num_cells, corners);
  (void)close(ends[0]);
  while (child > 0 && waitpid(child, NULL, 0) < 0 && errno == EINTR) continue;
  return outcome;
}
#endif
