/* Lists of fields: what a file has per vertex and cell beside its mesh. */
#ifndef EQM_MESH_FIELDS_H
#define EQM_MESH_FIELDS_H

#include <equimap/soup.h>

/* The field of a soup that holds texture coordinates: on cells, two numbers per corner. */
#define EQM_FIELD_TEXTURE "texcoord"
/* The number of the group (Gmsh's physical group, Medit's reference, OBJ's g) that a cell belongs to. */
#define EQM_FIELD_GROUP "group"
/* The number of the file's face that a triangle was cut from, where some faces have more than three corners. */
#define EQM_FIELD_POLYGON "polygon"

/* Append a field like `kind`, with room for `rows` rows, which the caller fills in. Not collective. */
PETSC_INTERN PetscErrorCode EqmMeshFieldsAdd(PetscInt *num_fields, EqmMeshField **fields, const EqmMeshField *kind,
                                             size_t rows, PetscReal **values);
/* Free them all. Not collective. */
PETSC_INTERN PetscErrorCode EqmMeshFieldsReset(PetscInt *num_fields, EqmMeshField **fields);
/* The field of that name on vertices or cells, or NULL. Not collective. */
PETSC_INTERN const EqmMeshField *EqmMeshFieldsFind(PetscInt num_fields, const EqmMeshField *fields, const char *name,
                                                   PetscBool on_cells);
/* Does a result have a field of that name itself, so that one of the input would be mistaken for it? Not collective. */
PETSC_INTERN PetscBool EqmMeshFieldIsOfResult(const char *name);
/* Make the texture coordinates of a serial mesh its field "texcoord", and the other way round. Not collective. */
PETSC_INTERN PetscErrorCode EqmMeshFieldsTakeTexture(EqmSerialMesh *mesh);
PETSC_INTERN PetscErrorCode EqmMeshFieldsGiveTexture(EqmSerialMesh *mesh);

#endif
