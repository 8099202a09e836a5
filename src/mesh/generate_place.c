/* Placements of the test shapes: from a lattice's parameters to points in space. */
#include "mesh/generate.h"
#include "geometry/simplex.h"

static PetscReal Random(const EqmLatticePlan *plan, PetscInt which, PetscInt channel, PetscReal low, PetscReal high)
{
  return low + (high - low) * EqmHashUniform(plan->seed, -1 - which, channel);
}

static void RandomDirection(const EqmLatticePlan *plan, PetscInt which, PetscReal direction[3])
{
  const PetscReal height = Random(plan, which, 0, -1.0, 1.0), angle = Random(plan, which, 1, 0.0, 2.0 * PETSC_PI);
  const PetscReal radius = PetscSqrtReal(1.0 - height * height);

  direction[0] = radius * PetscCosReal(angle);
  direction[1] = radius * PetscSinReal(angle);
  direction[2] = height;
}

/* Cap of the unit sphere with an opening angle of 115 degrees from the pole, finer near the pole. */
void EqmPlaceCap(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  const PetscReal radius = PetscSqrtReal(parameter[0] * parameter[0] + parameter[1] * parameter[1]);
  const PetscReal polar = 2.0 * radius * (0.6 + 0.4 * radius);
  const PetscReal scale = radius > 0.0 ? PetscSinReal(polar) / radius : 0.0;

  (void)plan;
  position[0] = scale * parameter[0];
  position[1] = scale * parameter[1];
  position[2] = PetscCosReal(polar);
}

/* Rectangle of 4 by 3, rolled on the unit cylinder, with uneven columns and rows. */
void EqmPlacePatch(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  const PetscReal u = parameter[0] + 0.6 * PetscSinReal(2.0 * PETSC_PI * parameter[0]) / (2.0 * PETSC_PI);
  const PetscReal v = parameter[1] * (0.7 + 0.3 * parameter[1]);

  (void)plan;
  position[0] = PetscCosReal(4.0 * u);
  position[1] = PetscSinReal(4.0 * u);
  position[2] = 3.0 * v;
}

/* Square with peaks and pits of slopes up to about 8. */
void EqmPlaceHills(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  PetscReal height = 0.0;

  for (PetscInt peak = 0; peak < 9; peak++) {
    const PetscReal x = parameter[0] - Random(plan, peak, 0, 0.12, 0.88),
                    y = parameter[1] - Random(plan, peak, 1, 0.12, 0.88);
    const PetscReal width = Random(plan, peak, 2, 0.05, 0.11), tall = Random(plan, peak, 3, 0.25, 0.65);

    height += (peak % 3 == 2 ? -tall : tall) * PetscExpReal(-(x * x + y * y) / (2.0 * width * width));
  }
  position[0] = parameter[0];
  position[1] = parameter[1];
  position[2] = height;
}

/* Flat ring between the radii 1 and 2. */
void EqmPlaceAnnulus(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  const PetscReal angle = -2.0 * PETSC_PI * parameter[0], radius = 1.0 + parameter[1];

  (void)plan;
  position[0] = radius * PetscCosReal(angle);
  position[1] = radius * PetscSinReal(angle);
  position[2] = 0.0;
}

/* Moebius band of half width 0.4 around the unit circle. */
void EqmPlaceMoebius(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  const PetscReal angle = 2.0 * PETSC_PI * parameter[0], across = 0.8 * (parameter[1] - 0.5);
  const PetscReal radius = 1.0 + across * PetscCosReal(angle / 2.0);

  (void)plan;
  position[0] = radius * PetscCosReal(angle);
  position[1] = radius * PetscSinReal(angle);
  position[2] = across * PetscSinReal(angle / 2.0);
}

/* Torus of radii 1 and 0.4. */
void EqmPlaceTorus(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  const PetscReal angle = 2.0 * PETSC_PI * parameter[0], turn = 2.0 * PETSC_PI * parameter[1];
  const PetscReal radius = 1.0 + 0.4 * PetscCosReal(turn);

  (void)plan;
  position[0] = radius * PetscCosReal(angle);
  position[1] = radius * PetscSinReal(angle);
  position[2] = 0.4 * PetscSinReal(turn);
}

/* The unit sphere. */
void EqmPlaceSphere(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  (void)plan;
  for (int k = 0; k < 3; k++) position[k] = parameter[k];
}

/* Ellipsoid with smooth bumps and dents at random places. */
void EqmPlaceHead(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  static const PetscReal axis[3] = {0.85, 1.0, 1.25};
  PetscReal radius = 1.0;

  for (PetscInt bump = 0; bump < 14; bump++) {
    PetscReal direction[3];
    const PetscReal sharp = Random(plan, bump, 2, 6.0, 40.0), tall = Random(plan, bump, 3, 0.1, 0.35);

    RandomDirection(plan, bump, direction);
    radius += (bump % 3 == 2 ? -0.6 * tall : tall) * PetscExpReal(sharp * (EqmDot3(direction, parameter) - 1.0));
  }
  for (int k = 0; k < 3; k++) position[k] = radius * axis[k] * parameter[k];
}

/* Flat body with five arms, each about seven times as long as wide; vertices are drawn towards the arms. */
void EqmPlaceStarfish(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  PetscReal drawn[3], norm, radius = 0.45;

  for (int k = 0; k < 3; k++) drawn[k] = parameter[k];
  for (int arm = 0; arm < 5; arm++) {
    const PetscReal angle = 2.0 * PETSC_PI / 5.0 * (arm + Random(plan, arm, 0, -0.1, 0.1));
    const PetscReal axis[3] = {PetscCosReal(angle), PetscSinReal(angle), 0.0};
    const PetscReal pull = 2.5 * PetscExpReal(8.0 * (EqmDot3(axis, parameter) - 1.0));

    for (int k = 0; k < 3; k++) drawn[k] += pull * axis[k];
  }
  norm = PetscSqrtReal(EqmDot3(drawn, drawn));
  for (int k = 0; k < 3; k++) drawn[k] /= norm;
  for (int arm = 0; arm < 5; arm++) {
    const PetscReal angle = 2.0 * PETSC_PI / 5.0 * (arm + Random(plan, arm, 0, -0.1, 0.1));
    const PetscReal axis[3] = {PetscCosReal(angle), PetscSinReal(angle), 0.0};

    radius += Random(plan, arm, 1, 1.4, 2.2) * PetscExpReal(70.0 * (EqmDot3(axis, drawn) - 1.0));
  }
  for (int k = 0; k < 3; k++) position[k] = radius * drawn[k];
}

/* The cube [-1, 1]^3. */
void EqmPlaceCube(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  (void)plan;
  for (int k = 0; k < 3; k++) position[k] = parameter[k];
}

/* The unit ball: cubical shells become spherical ones towards the boundary, with equal angles on the six sides. */
void EqmPlaceBall(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  const PetscReal shell =
      PetscMax(PetscMax(PetscAbsReal(parameter[0]), PetscAbsReal(parameter[1])), PetscAbsReal(parameter[2]));
  PetscReal spread[3], norm;

  (void)plan;
  for (int k = 0; k < 3; k++) {
    spread[k] = shell > 0.0 ? shell * PetscTanReal(PETSC_PI / 4.0 * parameter[k] / shell) : 0.0;
  }
  norm = PetscSqrtReal(EqmDot3(spread, spread));
  for (int k = 0; k < 3; k++) {
    const PetscReal cubical = 0.65 * parameter[k], spherical = norm > 0.0 ? shell * spread[k] / norm : 0.0;

    position[k] = (1.0 - shell) * cubical + shell * spherical;
  }
}

/* The ball, stretched, bent and with bumps. */
void EqmPlaceBlob(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  const PetscReal bend = Random(plan, 20, 0, 0.3, 0.6), twist = Random(plan, 20, 1, 0.2, 0.5);
  PetscReal ball[3], radius = 1.0, x, y;

  EqmPlaceBall(plan, parameter, ball);
  for (PetscInt bump = 0; bump < 6; bump++) {
    PetscReal direction[3];
    const PetscReal tall = Random(plan, bump, 3, 0.1, 0.3);

    RandomDirection(plan, bump, direction);
    radius += tall * EqmDot3(ball, ball) * PetscExpReal(4.0 * (EqmDot3(direction, ball) - 1.0));
  }
  for (int k = 0; k < 3; k++) ball[k] *= radius;
  x = PetscCosReal(twist * ball[2]) * ball[0] - PetscSinReal(twist * ball[2]) * ball[1];
  y = PetscSinReal(twist * ball[2]) * ball[0] + PetscCosReal(twist * ball[2]) * ball[1];
  position[0] = x + bend * ball[2] * ball[2];
  position[1] = 0.8 * y;
  position[2] = 1.4 * ball[2];
}

/* A body with two arms, two legs and a head: limbs are pulled out of the ball along their axes, which turns nothing
   over however far they reach, and then twisted. */
void EqmPlaceFigure(const EqmLatticePlan *plan, const PetscReal parameter[3], PetscReal position[3])
{
  static const PetscReal axis[5][3] = {
      {0.96, 0.0, 0.28}, {-0.96, 0.0, 0.28}, {0.48, 0.14, -0.866}, {-0.48, 0.14, -0.866}, {0.0, 0.28, 0.96}};
  const PetscReal twist = Random(plan, 20, 0, 0.3, 0.6);
  PetscReal ball[3], drawn[3], angle;

  EqmPlaceBall(plan, parameter, ball);
  for (int k = 0; k < 3; k++) drawn[k] = 0.8 * ball[k];
  for (PetscInt limb = 0; limb < 5; limb++) {
    const PetscReal along = EqmDot3(axis[limb], ball), away = EqmDot3(ball, ball) - along * along;
    const PetscReal length = Random(plan, limb, 1, 0.9, 1.4), width = Random(plan, limb, 2, 0.33, 0.4);

    for (int k = 0; along > 0.0 && k < 3; k++) {
      drawn[k] += length * along * along * PetscExpReal(-0.5 * away / (width * width)) * axis[limb][k];
    }
  }
  angle = twist * drawn[0]; /* the limbs of one side turn forward, those of the other back */
  position[0] = drawn[0];
  position[1] = PetscCosReal(angle) * drawn[1] - PetscSinReal(angle) * drawn[2];
  position[2] = PetscSinReal(angle) * drawn[1] + PetscCosReal(angle) * drawn[2];
}
