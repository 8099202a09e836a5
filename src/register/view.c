/* What a registration prints. */
#include "register/registration.h"
#include "mesh/mesh_private.h"

PetscErrorCode EqmRegistrationViewInput(EqmRegistration r)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(r->comm, "%s, %" PetscInt_FMT " vertices, to ", r->a.soup->file, r->a.soup->num_vertices));
  if (r->bare)
    PetscCall(PetscPrintf(r->comm, "the target"));
  else
    PetscCall(PetscPrintf(r->comm, "%s, %" PetscInt_FMT " vertices", r->b.soup->file, r->b.soup->num_vertices));
  PetscCall(PetscPrintf(r->comm, ": equimap register can begin, by the %s\n", r->target));
  PetscFunctionReturn(0);
}

/* Where vertices fell outside the other's image. */
static PetscErrorCode ViewOutside(EqmRegistration r)
{
  const EqmLocation on_b = r->forward, on_a = r->inverse;

  PetscFunctionBegin;
  if (on_b->num_clamped + on_a->num_clamped == 0) PetscFunctionReturn(0);
  PetscCall(PetscPrintf(r->comm,
                        "  outside       %" PetscInt64_FMT
                        " vertices of A lay outside B's image, by %.2e at most, and %" PetscInt64_FMT
                        " of B outside A's, by %.2e: taken to the closest point\n",
                        on_b->num_clamped, (double)on_b->most_distant, on_a->num_clamped, (double)on_a->most_distant));
  PetscFunctionReturn(0);
}

PetscErrorCode EqmRegistrationView(EqmRegistration r)
{
  const EqmRegisterFigures *const f = &r->figures;
  const EqmDistortion *const d = &r->map->distortion;

  PetscFunctionBegin;
  if (r->status == EQM_STATUS_STOPPED) {
    if (!r->stop_reported) PetscCall(PetscPrintf(r->comm, "%s: %s\n", EqmStatusName(r->status), r->message));
    PetscFunctionReturn(0);
  }
  PetscCall(PetscPrintf(r->comm, "\n%s -> %s by the %s\n  %s: %s\n", r->a.soup->file,
                        r->bare ? "the target" : r->b.soup->file, r->target, EqmStatusName(r->status), r->message));
  PetscCall(PetscPrintf(r->comm, "  energy        %.6e of the map of A to the target, %" PetscInt64_FMT " folds\n",
                        (double)f->energy, r->map->distortion.folds));
  PetscCall(PetscPrintf(r->comm, "  ratio         sd %.3e   min %.4f   median %.6f   max %.4f, A to B in space\n",
                        (double)d->ratio.sd, (double)d->ratio.min, (double)d->ratio.p50, (double)d->ratio.max));
  if (r->landmarks.num)
    PetscCall(PetscPrintf(r->comm, "  landmarks     %" PetscInt_FMT ", error mean %.3e, max %.3e in the target\n",
                          r->landmarks.num, (double)f->landmark_mean, (double)f->landmark_max));
  if (r->landmarks.num && r->kind != EQM_IMAGE_SPACE)
    PetscCall(PetscPrintf(r->comm, "  h             energy %.3e, from the target to itself\n", (double)f->own_energy));
  if (r->set.frames)
    PetscCall(PetscPrintf(r->comm,
                          "  frames        %" PetscInt_FMT ", at most %" PetscInt64_FMT " folded cells in one\n",
                          r->set.frames, f->most_frame_folds));
  if (!r->bare) {
    PetscCall(
        PetscPrintf(r->comm,
                    "  d(phi)        %.4e   mean distance from A to its points on B in radii; after the best rigid "
                    "motion %.4e\n",
                    (double)f->dissimilarity, (double)f->dissimilarity_rigid));
    PetscCall(ViewOutside(r));
  }
  PetscFunctionReturn(0);
}
