/* Text in files that are there complete or not at all. */
#include "base/atomicfile.h"
#include <errno.h>
#include <stdarg.h>

/* EqmAtomicPrint - append text like fprintf. Not collective. A failure is remembered and reported by EqmAtomicCommit.
   Real numbers belong to EqmAtomicPrintReals: printf writes the locale's decimal comma. */
void EqmAtomicPrint(EqmAtomicFile *file, const char *format, ...)
{
  va_list arguments;

  if (file->error_number) return;
  errno = 0;
  va_start(arguments, format);
  if (vfprintf(file->stream, format, arguments) < 0) file->error_number = errno ? errno : EIO;
  va_end(arguments);
}

/* EqmAtomicPrintReals - append `count` numbers with a separator between them, with the digits that bring back the same
   bits (%.17g), and with a decimal point in every locale. Not collective. */
void EqmAtomicPrintReals(EqmAtomicFile *file, PetscInt count, const PetscReal *values, char separator)
{
  for (PetscInt i = 0; i < count; ++i) {
    char text[40];
    int used = snprintf(text, sizeof(text), "%.17g", (double)values[i]);

    for (int k = 0; k < used; ++k) {
      if (text[k] == ',') text[k] = '.';
    }
    if (i + 1 < count) text[used++] = separator;
    EqmAtomicWrite(file, text, (size_t)used);
  }
}

/* EqmAtomicPrintLine - a printer: a text and a newline; NULL if there was no memory for the text. Not collective. */
void EqmAtomicPrintLine(EqmAtomicFile *file, void *text)
{
  if (text)
    EqmAtomicPrint(file, "%s\n", (const char *)text);
  else
    file->error_number = ENOMEM;
}

/* EqmAtomicPrintFile - rank 0 writes a file whose contents `print` prints; all ranks learn how it ended.

   Collective; `print` runs on rank 0 only. Errors: EQM_ERR_IO on all ranks. */
PetscErrorCode EqmAtomicPrintFile(MPI_Comm comm, const char *path, EqmAtomicPrinter print, void *context)
{
  char message[EQM_MESSAGE_MAX] = "";
  PetscErrorCode error = 0;
  EqmAtomicFile file;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) {
    error = EqmAtomicOpen(path, &file, message, sizeof(message));
    if (!error) {
      print(&file, context);
      error = EqmAtomicCommit(&file, message, sizeof(message));
    }
  }
  PetscCall(EqmAgree(comm, error, message));
  PetscFunctionReturn(0);
}
