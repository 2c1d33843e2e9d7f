// The commands of Gridlock that many ranks run together: mpirun -n 8 gridlock-mpi run FILE -o DIR
#include "gridlock/mpi_command_line.hpp"

int main(int argc, char** argv) { return gridlock::mpi_command_line(argc, argv); }
