// Entry point of gridlock-mpi, for runs and sweeps on several ranks: mpirun -n 8 gridlock-mpi run FILE -o DIR
#include "gridlock/mpi_command_line.hpp"

int main(int argc, char** argv) { return gridlock::mpi_command_line(argc, argv); }
