// The same program for the ranks of MPI; tests/mpi/run_test.cpp runs it.
#include "../tiled_colloid.hpp"
#include "gridlock/mpi_command_line.hpp"
#include "market.hpp"
#include "schelling.hpp"

int main(int argc, char** argv) {
  register_model<Schelling>();
  register_model<Market>();
  register_model<Colloid>();
  register_model<TiledColloid>();
  return mpi_command_line(argc, argv);
}
