#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <string>
#include <vector>

#include "gridlock/io/table.hpp"
#include "program.hpp"

namespace gridlock::test {
namespace {

std::string const packings = std::string(GRIDLOCK_SOURCE_DIR) + "/tests/reference/packings/harmonic64_";

Outcome contacts(Workplace const& workplace, std::vector<std::string> words) {
  words.insert(words.begin(), "contacts");
  return Process(GRIDLOCK_PROGRAM, std::move(words), workplace.path()).wait();
}

nlohmann::json numbers_of(Workplace const& workplace, std::vector<std::string> words) {
  words.emplace_back("--json");
  Outcome const outcome = contacts(workplace, std::move(words));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return nlohmann::json::parse(outcome.out);
}

TEST(Contacts, OfAKnownPackingAreItsNumbersAndTables) {
  Workplace const workplace;
  auto const numbers = numbers_of(workplace, {packings + "over.xyz", "-o", "found", "--no-pictures"});
  EXPECT_EQ(numbers, nlohmann::json::parse(text_of(workplace / "found/summary.json")));
  double const unit = std::pow(numbers["smallest_diameter"].get<double>(), 2);
  EXPECT_EQ(numbers["backbone_contacts"], 145);
  EXPECT_NEAR(numbers["energy_per_disk"].get<double>(), 1.047687498e-4, 1e-13);
  EXPECT_NEAR(numbers["pressure"].get<double>() / unit, 0.5642768998, 1e-9);
  EXPECT_NEAR(numbers["bulk_modulus"].get<double>() / unit, 27.948968, 3e-5);
  EXPECT_NEAR(numbers["shear_modulus"].get<double>() / unit, 4.5018203, 5e-6);
  EXPECT_TRUE(numbers["is_jammed"].get<bool>() && numbers["is_shear_stable"].get<bool>());
  Table const table = read_csv(workplace / "found/contacts.csv");
  EXPECT_EQ(table.row_count(), 145U);
  double virial = 0.0;
  std::vector<double> const force = table.numbers("force"), distance = table.numbers("distance");
  for (std::size_t k = 0; k < force.size(); ++k) virial += force[k] * distance[k];
  EXPECT_NEAR(0.5 * virial, 0.5642768998, 1e-9);
  EXPECT_EQ(read_csv(workplace / "found/forces.csv").row_count(), 145U);
  EXPECT_EQ(read_csv(workplace / "found/gaps.csv").row_count(), 17U);
  EXPECT_GT(read_csv(workplace / "found/spectral_density.csv").row_count(), 10U);
  // The copy is the same packing.
  EXPECT_EQ(numbers_of(workplace, {"found/packing.xyz"}), numbers);
  Outcome const info = Process(GRIDLOCK_PROGRAM, {"info", "found"}, workplace.path()).wait();
  EXPECT_EQ(info.out.rfind("the contacts of a packing in found", 0), 0U) << info.out;
}

TEST(Contacts, AcrossAnEdgeNameTheImageThatIsTouched) {
  Workplace const workplace;
  write(workplace / "two.xyz",
        "2\nLattice=\"4 0 0 0 4 0 0 0 1\" pbc=\"T T F\" Properties=pos:R:3:id:I:1:radius:R:1\n"
        "3.75 0.1 0 7 0.5\n0.5 3.9 0 3 0.5\n");
  contacts(workplace, {"two.xyz", "-o", "found", "--no-pictures"});
  std::string const table = text_of(workplace / "found/contacts.csv");
  EXPECT_NE(table.find("\n3,7,0,"), std::string::npos) << table;
  Table const found = read_csv(workplace / "found/contacts.csv");
  EXPECT_EQ(found.numbers("image_x"), std::vector<double>{-1.0});
  EXPECT_EQ(found.numbers("image_y"), std::vector<double>{1.0});
  EXPECT_NEAR(found.numbers("normal_x")[0] * found.numbers("distance")[0], -0.75, 1e-12);
}

TEST(Contacts, WithWallsSayWhichOne) {
  Workplace const workplace;
  write(
      workplace / "one.xyz",
      "1\nLattice=\"0.98 0 0 0 0.96 0 0 0 1\" pbc=\"F F F\" Properties=pos:R:3:id:I:1:radius:R:1\n0.49 0.48 0 5 0.5\n");
  auto const numbers = numbers_of(workplace, {"one.xyz", "-o", "found", "--no-pictures"});
  EXPECT_TRUE(numbers["elastic_xyxy"].is_null()) << "a box between walls keeps its angles";
  EXPECT_TRUE(numbers["local_bond_orientation_order"].is_null());
  EXPECT_GT(numbers["shear_modulus"].get<double>(), 0.0);
  Table const table = read_csv(workplace / "found/contacts.csv");
  EXPECT_EQ(table.numbers("wall"), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(table.numbers("j"), (std::vector<double>{5, 5, 5, 5}));
  EXPECT_FALSE(fs::exists(workplace / "found/spectral_density.csv"));
}

TEST(Contacts, SayWhatTheNumbersAreNot) {
  Workplace const workplace;
  std::string text = text_of(packings + "mid.xyz");
  text.replace(text.find("0.4649103208"), 12, "0.4649103218");
  write(workplace / "shaken.xyz", text);
  Outcome const shaken = contacts(workplace, {"shaken.xyz"});
  EXPECT_NE(shaken.err.find("note: not a minimum: the root mean square of the net forces is"), std::string::npos)
      << shaken.err;
  EXPECT_NE(shaken.out.find("bulk_modulus                     –"), std::string::npos) << shaken.out;
  write(workplace / "hard.xyz",
        "2\nLattice=\"4 0 0 0 4 0 0 0 1\" pbc=\"T T F\" Properties=pos:R:3\n1 1 0\n2.000001 1 0\n");
  Outcome const hard = contacts(workplace, {"hard.xyz", "--radius", "0.5"});
  EXPECT_EQ(hard.exit_code, 0);
  EXPECT_NE(hard.err.find("note: no disks overlap"), std::string::npos) << hard.err;
  EXPECT_EQ(numbers_of(workplace, {"hard.xyz", "--radius", "0.5", "--tolerance", "1e-5"})["contacts"], 1);
  double const area = 3.141592653589793 * 0.5;
  auto const equal = numbers_of(workplace, {"hard.xyz", "--packing-fraction", std::to_string(area / 16.0)});
  EXPECT_NEAR(equal["smallest_diameter"].get<double>(), 1.0, 1e-5);
}

TEST(Contacts, OfASaddleAndWithAToleranceAreNotJammed) {
  Workplace const workplace;
  std::string square = "16\nLattice=\"4 0 0 0 4 0 0 0 1\" pbc=\"T T F\" Properties=pos:R:3\n";
  for (int k = 0; k < 16; ++k) square += std::to_string(k % 4) + ".5 " + std::to_string(k / 4) + ".5 0\n";
  write(workplace / "square.xyz", square);
  auto const saddle = numbers_of(workplace, {"square.xyz", "--radius", "0.51"});
  EXPECT_TRUE(saddle["is_converged"].get<bool>());
  EXPECT_GE(saddle["excess_contacts"], 0);
  EXPECT_FALSE(saddle["is_jammed"].get<bool>());
  EXPECT_FALSE(numbers_of(workplace, {"square.xyz", "--radius", "0.500000005"})["is_jammed"].get<bool>())
      << "at a pressure of 1e-8 too";
  Outcome const told = contacts(workplace, {"square.xyz", "--radius", "0.51"});
  EXPECT_NE(told.err.find("note: a saddle and not jammed"), std::string::npos) << told.err;
  auto const tolerant = numbers_of(workplace, {packings + "mid.xyz", "--tolerance", "1e-2"});
  EXPECT_GT(tolerant["backbone_contacts"], 119);
  EXPECT_TRUE(tolerant["is_jammed"].is_null());
  Outcome const marked = contacts(workplace, {packings + "mid.xyz", "--tolerance", "1e-2"});
  EXPECT_NE(marked.err.find(" contacts are gaps below the tolerance and carry no force: contact_number"),
            std::string::npos)
      << marked.err;
}

void expect_refused(Workplace const& workplace, std::vector<std::string> const& words, std::string const& text) {
  Outcome const outcome = contacts(workplace, words);
  EXPECT_EQ(outcome.exit_code, 2) << text;
  EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.out, "");
}

TEST(Contacts, RefuseWhatIsNoPacking) {
  Workplace const workplace;
  std::string const head = "Lattice=\"4 0 0 0 4 0 0 0 1\" pbc=\"T T F\" Properties=pos:R:3";
  write(workplace / "plain.xyz", "1\n" + head + "\n1 1 0\n");
  write(workplace / "none.xyz", "0\n" + head + ":radius:R:1\n");
  write(workplace / "deep.xyz",
        "2\nLattice=\"9 0 0 0 9 0 0 0 1\" pbc=\"T T F\" Properties=pos:R:3:radius:R:1\n1 1 0 1\n1.5 1 0 1\n");
  write(workplace / "outside.xyz",
        "1\nLattice=\"4 0 0 0 4 0 0 0 1\" pbc=\"F F F\" Properties=pos:R:3:radius:R:1\n5 1 0 1\n");
  write(workplace / "empty.xyz", "");
  expect_refused(workplace, {"plain.xyz"}, "plain.xyz has no radii");
  expect_refused(workplace, {"plain.xyz", "--radius", "-1"}, "--radius must be a number above 0, but is -1");
  expect_refused(workplace, {"plain.xyz", "--radius", "nan"}, "--radius must be a number above 0, but is nan");
  expect_refused(workplace, {"plain.xyz", "--radius", "x"}, "--radius needs a number, but is \"x\"");
  expect_refused(workplace, {"plain.xyz", "--radius", "1", "--packing-fraction", "0.1"}, "cannot be given together");
  expect_refused(workplace, {"none.xyz"}, "none.xyz has no disks");
  expect_refused(workplace, {"empty.xyz"}, "the file is empty");
  expect_refused(workplace, {"deep.xyz", "--radius", "1"}, "deep.xyz has radii of its own");
  expect_refused(workplace, {"deep.xyz"},
                 "disk 0 and disk 1 are 0.5 apart and should be 2: an overlap of 0.75, which is no packing");
  expect_refused(workplace, {"outside.xyz"}, "its centre is outside the walls");
  expect_refused(workplace, {"missing.xyz"}, "missing.xyz");
  expect_refused(workplace, {packings + "mid.xyz", "--tolerance", "2"}, "--tolerance must be a number from 0 to 1");
  expect_refused(workplace, {packings + "mid.xyz", "--potential", "soft"}, "--potential must be one of");
}

TEST(Contacts, ReplaceNoResultsUnlessToldTo) {
  Workplace const workplace;
  std::vector<std::string> words{packings + "mid.xyz", "-o", "found", "--no-pictures"};
  EXPECT_EQ(contacts(workplace, words).exit_code, 0);
  std::string const first = text_of(workplace / "found/contacts.csv");
  write(workplace / "found/mine.txt", "a note");
  expect_refused(workplace, words, "found holds results already");
  words.emplace_back("--overwrite");
  EXPECT_EQ(contacts(workplace, words).exit_code, 0);
  EXPECT_EQ(text_of(workplace / "found/contacts.csv"), first);
  EXPECT_TRUE(fs::exists(workplace / "found/mine.txt"));
}

}  // namespace
}  // namespace gridlock::test
