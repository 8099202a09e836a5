/* The formats that there are, in the order of recognition: those that say clearly what they are come first, guesses
   last. A line X(Name) stands for the row EqmFormatName, which the format's own file defines. */
#ifndef EQM_FORMAT_FORMATS_H
#define EQM_FORMAT_FORMATS_H

#define EQM_FORMAT_LIST(X)                                                                                             \
  X(Hdf5)                                                                                                              \
  X(Ply)                                                                                                               \
  X(Vtu)                                                                                                               \
  X(Vtp)                                                                                                               \
  X(Gifti)                                                                                                             \
  X(Xdmf)                                                                                                              \
  X(Vtk)                                                                                                               \
  X(Freesurfer)                                                                                                        \
  X(Curvature)                                                                                                         \
  X(Gmsh)                                                                                                              \
  X(Medit)                                                                                                             \
  X(Meshb)                                                                                                             \
  X(Off)                                                                                                               \
  X(Stl)                                                                                                               \
  X(Tetgen)                                                                                                            \
  X(Obj)

#endif
