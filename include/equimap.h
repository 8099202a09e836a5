/* equimap: area-, volume- and angle-preserving maps of triangle and tetrahedral meshes. The public interface. */
#ifndef EQUIMAP_H
#define EQUIMAP_H

#include <equimap/base.h>
#include <equimap/simplex.h>
#include <equimap/soup.h>
#include <equimap/mesh.h>
#include <equimap/map.h>
#include <equimap/domain.h>
#include <equimap/energy.h>
#include <equimap/solver.h>
#include <equimap/register.h>

#endif
