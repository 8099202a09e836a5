/* Whatever the bytes of a file are, a parser returns: with a mesh that holds together or with an error that has a text.
 */
#include <equimap/soup.h>
#include "format/format.h"
#include "format_samples.h"
#include "mutations.h"
#include "support/checks.h"

#define MUTATIONS 600 /* of each sample and rank */

static PetscBool HoldsTogether(const EqmSerialMesh *mesh)
{
  if (mesh->num_cells < 1 || mesh->num_vertices < 0 || (mesh->cell_size != 3 && mesh->cell_size != 4))
    return PETSC_FALSE;
  for (PetscInt i = 0; i < mesh->num_cells * mesh->cell_size; ++i) {
    if (mesh->cells[i] < 0 || mesh->cells[i] >= mesh->num_vertices) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Parse a copy that ends where its memory ends, so that a memory checker sees every step beyond. */
static void Try(const Sample *s, const EqmFormat *format, const char *bytes, size_t length, const char *what,
                long long which)
{
  EqmSerialMesh mesh = {0};
  char error[256] = "", *copy = malloc(length ? length : 1);
  PetscErrorCode code;

  if (!copy) abort();
  memcpy(copy, bytes, length);
  (void)EqmFormatOfContent(copy, length);
  code = format->parse(copy, length, &mesh, error, sizeof(error));
  CHECK(code ? (code == EQM_ERR_IO || code == EQM_ERR_MESH) && error[0] && !mesh.vertices : HoldsTogether(&mesh),
        "%s, %s %lld: code %d, message \"%s\"", s->name, what, which, (int)code, error);
  CHECK(EqmSerialMeshReset(&mesh) == 0);
  free(copy);
}

int main(int argc, char **argv)
{
  Sample *samples = malloc(MAX_SAMPLES * sizeof(*samples)), changed;
  int count, rank;
  uint64_t state;

  if (EqmInitialize(&argc, &argv)) return 1;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  count = MakeSamples(samples);
  for (int i = 0; i < count; ++i) {
    const Sample *s = &samples[i];
    const EqmFormat *format = EqmFormatOfContent(s->bytes, s->length);

    CHECK(format && format->parse, "%s is not recognised", s->name);
    if (rank == 0) {
      for (size_t length = 0; length <= s->length; ++length)
        Try(s, format, s->bytes, length, "cut to", (long long)length);
    }
    state = (uint64_t)(1000 * i + rank);
    for (int k = 0; k < MUTATIONS; ++k) {
      changed = *s;
      Try(s, format, changed.bytes, Mutate(changed.bytes, s->length, &state), "mutation", k);
    }
  }
  free(samples);
  return EqmFinalize() ? 1 : 0;
}
