// Keys and tokens as files, without a server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "access/key_folder.h"
#include "access/private_file.h"

namespace helio::access {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Access : public testing::Test {
 protected:
  Access() {
    std::string name = testing::TempDir() + "heliograph_access_XXXXXX";
    folder_ = mkdtemp(name.data());
  }
  ~Access() override { fs::remove_all(folder_); }

  static mode_t modeOf(const fs::path& path) {
    struct stat status {};
    EXPECT_EQ(::stat(path.c_str(), &status), 0) << path;
    return status.st_mode & 0777;
  }

  fs::path folder_;
};

TEST_F(Access, SecretsAreForTheirOwnerAlone) {
  const KeyFolder keys(folder_ / "a" / "keys");
  ASSERT_TRUE(keys.create({"localhost"}).ok());
  ASSERT_TRUE(keys.tokens().create({"admin", Scope::admin, {}, 0}).ok());
  EXPECT_EQ(modeOf(keys.path()), 0700u);
  for (const auto& file : {keys.key(), keys.authorityKey(), keys.tokens().path()}) EXPECT_EQ(modeOf(file), 0600u);
  EXPECT_TRUE(keys.check().ok());
}

TEST_F(Access, AFailedWriteLeavesWhatWasThere) {
  const auto path = folder_ / "secret";
  ASSERT_TRUE(writePrivateFile(path, "first").ok());
  ASSERT_TRUE(writePrivateFile(path, "second").ok());
  EXPECT_EQ(*readFile(path), "second");
  const auto failed = writePrivateFile(folder_ / "secret" / "below a file", "third");
  ASSERT_FALSE(failed.ok());
  EXPECT_THAT(failed.error().message, HasSubstr("cannot write"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "a temporary file is left";
}

TEST_F(Access, TheServersCertificateIsForItsHostsAndSignedByItsAuthority) {
  const auto authority = makeAuthority("test"), stranger = makeAuthority("test");
  ASSERT_TRUE(authority.ok() && stranger.ok());
  const auto server = makeServerCertificate(*authority, {"example.org", "192.0.2.7", "2001:db8::1"});
  ASSERT_TRUE(server.ok()) << server.error().message;
  const auto facts = inspectCertificate(server->certificate);
  ASSERT_TRUE(facts.ok());
  EXPECT_THAT(facts->hosts, testing::ElementsAre("example.org", "192.0.2.7", "2001:db8::1"));
  EXPECT_LT(facts->not_before, unixTime());
  EXPECT_GT(facts->not_after, unixTime() + 800 * 86'400);
  EXPECT_TRUE(checkIdentity(*server, authority->certificate).ok());
  EXPECT_THAT(checkIdentity(*server, stranger->certificate).error().message, HasSubstr("not signed"));
  EXPECT_THAT(checkIdentity({server->certificate, authority->key}, authority->certificate).error().message,
              HasSubstr("does not belong"));
  EXPECT_NE(*fingerprintOf(authority->certificate), *fingerprintOf(stranger->certificate));
  EXPECT_EQ(fingerprintOf(authority->certificate)->size(), 64u);
  EXPECT_FALSE(fingerprintOf("nothing").ok());
  for (const char* bad : {"", "a b", "host:7700", "evil,DNS:*", "x\n"})
    EXPECT_FALSE(makeServerCertificate(*authority, {bad}).ok()) << bad;
  EXPECT_FALSE(makeServerCertificate(*authority, {}).ok());
}

TEST_F(Access, KeysAreNotMadeTwiceAndRenewingKeepsTheAuthority) {
  const KeyFolder keys(folder_ / "keys");
  EXPECT_THAT(keys.check().error().message, HasSubstr("heliographd init"));
  EXPECT_FALSE(keys.renew({"localhost"}).ok());
  ASSERT_TRUE(keys.create({"localhost"}).ok());
  const auto fingerprint = *keys.fingerprint();
  const auto certificate = *readFile(keys.certificate());
  EXPECT_EQ(keys.create({"localhost"}).error().kind, ErrorKind::conflict);
  ASSERT_TRUE(keys.renew({"other"}).ok());
  EXPECT_EQ(*keys.fingerprint(), fingerprint);
  EXPECT_NE(*readFile(keys.certificate()), certificate);
  EXPECT_TRUE(
      checkIdentity({*readFile(keys.certificate()), *readFile(keys.key())}, *readFile(keys.authorityCertificate()))
          .ok());
}

TEST_F(Access, ATokenIsFoundByItsTextAndByNothingElse) {
  const TokenFile file(folder_ / "tokens.json");
  const auto one = file.create({"one", Scope::view, {"city"}, 60}), two = file.create({"two", Scope::admin, {}, 0});
  ASSERT_TRUE(one.ok() && two.ok());
  const auto tokens = *file.read();
  ASSERT_EQ(tokens.size(), 2u);
  const auto* found = find(tokens, one->text);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->name, "one");
  EXPECT_EQ(found->scope, Scope::view);
  EXPECT_THAT(found->worlds, testing::ElementsAre("city"));
  EXPECT_FALSE(found->expired(found->created + 59));
  EXPECT_TRUE(found->expired(found->created + 60));
  // Every digit of the secret counts, and one token's secret is no other's.
  for (size_t i = one->text.size() - 64; i < one->text.size(); ++i) {
    auto wrong = one->text;
    wrong[i] = wrong[i] == '0' ? '1' : '0';
    EXPECT_EQ(find(tokens, wrong), nullptr) << i;
  }
  EXPECT_EQ(find(tokens, one->text.substr(0, 19) + two->text.substr(19)), nullptr);
  for (const auto& bad : {std::string(), std::string("helio_"), one->text + "0", one->text.substr(1)})
    EXPECT_EQ(find(tokens, bad), nullptr) << bad;
  // The file does not hold them.
  const auto bytes = *readFile(file.path());
  for (const auto& text : {one->text, two->text}) EXPECT_EQ(bytes.find(text.substr(19)), std::string::npos);

  ASSERT_TRUE(file.revoke(one->token.id).ok());
  EXPECT_EQ(find(*file.read(), one->text), nullptr);
  EXPECT_NE(find(*file.read(), two->text), nullptr);
  EXPECT_EQ(file.revoke(one->token.id).error().kind, ErrorKind::not_found);
}

TEST_F(Access, BadWishesAndDamagedFilesAreRefused) {
  const TokenFile file(folder_ / "tokens.json");
  EXPECT_EQ(file.read().error().kind, ErrorKind::not_found);
  for (const TokenFile::Wish& wish : {TokenFile::Wish{"", Scope::view, {}, 0},
                                      {std::string(65, 'x'), Scope::view, {}, 0},
                                      {"line\nbreak", Scope::view, {}, 0},
                                      {"x", Scope::none, {}, 0},
                                      {"x", Scope::view, {}, -1}})
    EXPECT_EQ(file.create(wish).error().kind, ErrorKind::invalid) << wish.name;
  for (
      const char* bad :
      {"", "{}", R"({"schema": "heliograph.tokens/2", "tokens": []})",
       R"({"schema": "heliograph.tokens/1", "tokens": [{"id": "0123456789ab"}]})",
       R"({"schema": "heliograph.tokens/1", "tokens": [{"id": "0123456789ab", "name": "x", "scope": "root", "worlds": [],
            "created": 0, "expires": 0, "sha256": ""}]})"}) {
    std::ofstream(file.path()) << bad;
    EXPECT_EQ(file.read().error().kind, ErrorKind::damaged) << bad;
    EXPECT_FALSE(file.create({"x", Scope::view, {}, 0}).ok()) << "a damaged file was replaced";
  }
}

TEST_F(Access, WritersAtTheSameTimeLoseNothing) {
  const TokenFile file(folder_ / "tokens.json");
  std::vector<std::thread> writers;
  for (int w = 0; w < 4; ++w)
    writers.emplace_back([&] {
      for (int i = 0; i < 10; ++i) EXPECT_TRUE(file.create({"x", Scope::view, {}, 0}).ok());
    });
  for (auto& writer : writers) writer.join();
  EXPECT_EQ(file.read()->size(), 40u);
}

}  // namespace
}  // namespace helio::access
