#include "tools/io/checkpoint.h"

#include <map>
#include <numeric>
#include <regex>
#include <set>

#include "core/errors.h"
#include "core/text_hash.h"
#include "tests/tools/full_disk.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

class Checkpoint : public Scratch {
 protected:
  void SetUp() override {
    Scratch::SetUp();
    file_ = folder / "checkpoint.bin";
    write_checkpoint(file_, kState);
    bytes_ = bytes_of(file_);
  }
  void put(const std::string& bytes) const { file("checkpoint.bin", bytes); }

  const std::string kState = std::string("state\0 with zeros\n", 18);
  std::filesystem::path file_;
  std::string bytes_;
};

TEST_F(Checkpoint, HoldsWhatWasWritten) {
  EXPECT_EQ(read_checkpoint(file_), kState);
  write_checkpoint(file_, "");
  EXPECT_EQ(read_checkpoint(file_), "");
}

TEST_F(Checkpoint, LayoutIsAsDocumented) {
  // 8 + (1 byte of cereal that says little-endian) + 4 + 4 + 8 bytes, then the state.
  ASSERT_EQ(bytes_.size(), 25 + kState.size());
  EXPECT_EQ(bytes_.substr(0, 9), "kf-state\1");
  EXPECT_EQ(bytes_.substr(9, 4), std::string("\17\0\0\0", 4));
  EXPECT_EQ(bytes_.substr(17, 8), std::string("\22\0\0\0\0\0\0\0", 8));
  EXPECT_EQ(bytes_.substr(25), kState);
}

TEST_F(Checkpoint, AnyFlippedBitOrMissingByteIsRefused) {
  for (std::size_t byte = 0; byte < bytes_.size(); ++byte) {
    std::string flipped = bytes_;
    flipped[byte] = static_cast<char>(flipped[byte] ^ 4);
    put(flipped);
    EXPECT_THROW(read_checkpoint(file_), Error) << byte;
    put(bytes_.substr(0, byte));
    EXPECT_THROW(read_checkpoint(file_), IoError) << byte;
  }
  put(bytes_ + "x");
  EXPECT_EQ(message_of<IoError>([&] { read_checkpoint(file_); }),
            file_.string() + ": the checkpoint is damaged: its checksum does not match");
  put("something else altogether, and long enough");
  EXPECT_EQ(message_of<IoError>([&] { read_checkpoint(file_); }),
            file_.string() + ": is not a checkpoint of kappaflow");
}

TEST_F(Checkpoint, AnotherFormatIsNamed) {
  std::string later = bytes_;
  later[9] = 77;
  put(later);
  EXPECT_NE(message_of<InvalidInput>([&] { read_checkpoint(file_); }).find("a checkpoint of format 77; "),
            std::string::npos);
}

TEST_F(Checkpoint, FullDiskLeavesTheLastOne) {
  {
    const FullDisk full(4096);
    EXPECT_THROW(write_checkpoint(file_, std::string(100000, 'x')), IoError);
  }
  EXPECT_EQ(read_checkpoint(file_), kState);
}

/// The functions that save states or say which arrays a mesh has, word for word but for blanks and comments,
/// sorted: moving one changes nothing.
std::string saving_functions() {
  const std::regex comment("//[^\n]*"), blank("\\s+"),
      function(
          "(serialize\\(Archive&archive|for_each_own_array\\(Mesh&mesh|::write_checkpoint\\(\\)|"
          "write_state\\(StateWriter&archive|\\]\\(StateWriter&archive)[^;{]*\\{");
  std::multiset<std::string> functions;
  const auto collect = [&](const std::filesystem::path& file) {
    std::string text = std::regex_replace(std::regex_replace(bytes_of(file), comment, ""), blank, "");
    for (std::smatch found; std::regex_search(text, found, function);
         text = text.substr(found.position() + 1)) {
      std::size_t end = found.position() + found.length();
      for (int depth = 1; depth > 0; ++end) depth += text[end] == '{' ? 1 : text[end] == '}' ? -1 : 0;
      functions.insert(text.substr(found.position(), end - found.position()) + "\n");
    }
  };
  for (const char* part : {"core", "solver", "surface", "tools"})
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(std::filesystem::path(KAPPAFLOW_SOURCE_DIR) / part))
      if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp") collect(entry.path());
  return std::accumulate(functions.begin(), functions.end(), std::string());
}

/// What was saved in each format. A new line here goes with a new kCheckpointFormat.
const std::map<std::uint32_t, std::string> kFingerprints{
    {3, "fnv1a64:7d099df4ba2b9f48"},  {4, "fnv1a64:293c961b76ee8448"},  {5, "fnv1a64:182fe77ae7c73c16"},
    {6, "fnv1a64:182fe77ae7c73c16"},  {7, "fnv1a64:e51fb08d084b46a6"},  {8, "fnv1a64:dde5bb2f7cf3353d"},
    {9, "fnv1a64:6dd15e9a68aea971"},  {10, "fnv1a64:99c3c28c012158eb"}, {11, "fnv1a64:d03e485498b196e7"},
    {12, "fnv1a64:d0fd73cdce2bb271"}, {13, "fnv1a64:9911f7dcc8c97d0d"}, {14, "fnv1a64:9c492722a874b307"},
    {15, "fnv1a64:c9169e6195e878ea"}};

TEST(CheckpointFormat, IsRaisedWhenAStateIsSavedInAnotherWay) {
  ASSERT_TRUE(kFingerprints.contains(kCheckpointFormat));
  EXPECT_EQ(text_hash(saving_functions()), kFingerprints.at(kCheckpointFormat))
      << "a serialize() is not what it was when the format was given its number: raise kCheckpointFormat, "
         "add the fingerprint, and make tests/data/checkpoint anew by tests/tools/io/renew_checkpoint";
}

}  // namespace
}  // namespace kappaflow
