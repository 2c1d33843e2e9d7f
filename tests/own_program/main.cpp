// A program with models of its own, as a user would write it; tests/cli/own_program_test.cpp runs its commands.
#include "../tiled_colloid.hpp"
#include "gridlock/command_line.hpp"
#include "market.hpp"
#include "schelling.hpp"

int main(int argc, char** argv) {
  register_model<Schelling>();
  register_model<Market>();
  register_model<Colloid>();
  register_model<TiledColloid>();
  return command_line(argc, argv);
}
