# EQUIMAP_MPIEXEC - the words that start %n ranks, also where these are more than the cores: the launcher and the flags that
# FindMPI knows, and what the kind of launcher needs so that ranks that wait leave the cores to the others. MPICH starts more
# ranks than there are cores, and binds none, without being asked.
execute_process(COMMAND ${MPIEXEC_EXECUTABLE} --version OUTPUT_VARIABLE version ERROR_VARIABLE version)
set(EQUIMAP_MPIEXEC ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} %n)
if(version MATCHES "Open MPI|OpenRTE|PRRTE|prte")
  list(APPEND EQUIMAP_MPIEXEC --oversubscribe --bind-to none --mca mpi_yield_when_idle 1)
elseif(version MATCHES "Intel")
  list(APPEND EQUIMAP_MPIEXEC -genv I_MPI_PIN off)
endif()
list(APPEND EQUIMAP_MPIEXEC ${MPIEXEC_PREFLAGS})
string(REGEX MATCH "[^\n]+" version "${version}")
message(STATUS "Launcher of the tests: ${EQUIMAP_MPIEXEC} (${version})")
