// Edits over the wire: all or none, once, in order, and seen.
#include <cmath>
#include <thread>

#include "fixture.h"

namespace helio::test {
namespace {

using Code = grpc::StatusCode;
using Stub = v1::WorldService::Stub;

class EditTest : public ServiceTest {
 protected:
  void SetUp() override { makeWorld("city"); }

  uint64_t instances() {
    v1::GetWorldRequest request;
    request.set_world("city");
    v1::World world;
    EXPECT_TRUE(call(&Stub::GetWorld, request, world).status.ok());
    return world.instances();
  }
};

TEST_F(EditTest, AnEditIsInTheFirstFrameThatSaysSo) {
  Viewer viewer(*viewers_, "city", 64, 32);
  EXPECT_EQ(viewer.frame().applied_seq(), 0u);
  const uint64_t slots = renderer_.slots();
  v1::ApplyEditsResponse answer;
  ASSERT_TRUE(apply(buildRequest("city", "a", 5), answer).status.ok());
  EXPECT_EQ(answer.seq(), 1u);
  ASSERT_EQ(answer.built_size(), 1);
  EXPECT_EQ(answer.built(0).count(), 1u);
  EXPECT_FALSE(answer.replayed());
  const auto frame = viewer.frameWhere([](const v1::Frame& f) { return f.applied_seq() >= 1; });
  EXPECT_EQ(frame.applied_seq(), 1u);
  EXPECT_GE(renderer_.slots(), slots + 1) << "the renderer was not told";
}

TEST_F(EditTest, TheIdsOfTheAnswerAreTheOnesThatAreThere) {
  auto request = buildRequest("city", "a", 50'000);
  for (const float number : {50'010.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 1.0f, 2.0f})
    request.mutable_edits(0)->mutable_build()->add_placements(number);
  v1::ApplyEditsResponse answer;
  ASSERT_TRUE(apply(request, answer).status.ok());
  ASSERT_EQ(answer.built(0).count(), 2u);
  v1::QueryInstancesRequest query;
  query.set_world("city");
  query.set_x(50'005);
  query.set_radius(100);
  query.set_page_size(1);
  query.set_min_seq(answer.seq());
  std::vector<uint64_t> ids;
  v1::QueryInstancesResponse page;
  do {
    ASSERT_TRUE(call(&Stub::QueryInstances, query, page).status.ok());
    for (const auto& instance : page.instances()) {
      ids.push_back(instance.id());
      EXPECT_EQ(instance.prefab(), buildable_);
      EXPECT_EQ(instance.transform_size(), 12);
    }
    query.set_page_token(page.next_page_token());
  } while (!page.next_page_token().empty());
  EXPECT_EQ(ids, (std::vector<uint64_t>{answer.built(0).first(), answer.built(0).first() + 1}));
}

TEST_F(EditTest, ABatchThatFailsInTheMiddleChangesNothing) {
  const uint64_t before = instances();
  auto request = buildRequest("city", "a", 1);
  request.add_edits()->mutable_destroy()->add_ids(999'999'999);
  *request.add_edits() = request.edits(0);
  v1::ApplyEditsResponse answer;
  const auto ended = apply(request, answer);
  EXPECT_EQ(ended.status.error_code(), Code::NOT_FOUND) << ended.status.error_message();
  EXPECT_EQ(ended.detail.field(), "edits[1].destroy.ids[0]");
  EXPECT_EQ(instances(), before);
  EXPECT_EQ(seqOf("city"), 0u);
  // The request id was not used up.
  ASSERT_TRUE(apply(buildRequest("city", "a", 1), answer).status.ok());
  EXPECT_EQ(answer.seq(), 1u);
  EXPECT_FALSE(answer.replayed());
  expectServing("city");
}

TEST_F(EditTest, TheSameRequestAgainGetsTheSameAnswer) {
  v1::ApplyEditsResponse first, other, again;
  ASSERT_TRUE(apply(buildRequest("city", "a", 1), first).status.ok());
  ASSERT_TRUE(apply(buildRequest("city", "b", 2), other).status.ok());
  const uint64_t count = instances();
  auto request = buildRequest("city", "a", 1);
  request.set_expected_seq(0);  // it held when the request was first sent
  ASSERT_TRUE(apply(request, again).status.ok());
  EXPECT_TRUE(again.replayed());
  EXPECT_EQ(again.seq(), first.seq());
  EXPECT_EQ(again.epoch(), first.epoch());
  ASSERT_EQ(again.built_size(), 1);
  EXPECT_EQ(again.built(0).first(), first.built(0).first());
  EXPECT_EQ(instances(), count);
  EXPECT_EQ(seqOf("city"), 2u);
}

TEST_F(EditTest, TheSameRequestFromManyThreadsIsAppliedOnce) {
  const uint64_t before = instances();
  std::atomic<int> fresh = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&] {
      v1::ApplyEditsResponse answer;
      EXPECT_TRUE(apply(buildRequest("city", "same", 1), answer).status.ok());
      fresh += !answer.replayed();
    });
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(fresh, 1);
  EXPECT_EQ(instances(), before + 1);
}

TEST_F(EditTest, ExpectedSeq) {
  v1::ApplyEditsResponse answer;
  auto request = buildRequest("city", "a", 1);
  request.set_expected_seq(0);
  ASSERT_TRUE(apply(request, answer).status.ok());
  request.set_request_id("b");
  const auto ended = apply(request, answer);
  expectFailure(ended, Code::ABORTED, v1::ERROR_REASON_SEQ_MISMATCH, "expected_seq");
  EXPECT_EQ(ended.detail.value(), "1");
  EXPECT_EQ(seqOf("city"), 1u);
  expectServing("city");
}

TEST_F(EditTest, DestroyMoveAndSunAreApplied) {
  v1::ApplyEditsResponse built, answer;
  ASSERT_TRUE(apply(buildRequest("city", "a", 40'000), built).status.ok());
  v1::ApplyEditsRequest request;
  request.set_world("city");
  request.set_request_id("b");
  auto& move = *request.add_edits()->mutable_move();
  move.set_id(built.built(0).first());
  for (const float number : {40'500.0f, 1.0f, 2.0f, 0.0f, 0.0f, 0.0f, 1.0f, 1.0f}) move.add_placement(number);
  request.add_edits()->mutable_set_sun()->mutable_daylight()->set_elevation(0.1f);
  ASSERT_TRUE(apply(request, answer).status.ok());
  request.Clear();
  request.set_world("city");
  request.set_request_id("c");
  auto& region = *request.add_edits()->mutable_destroy_region();
  region.set_x(40'500);
  region.set_z(2);
  region.set_radius(50);
  ASSERT_TRUE(apply(request, answer).status.ok());
  EXPECT_EQ(answer.destroyed(), 1u);
  EXPECT_EQ(answer.seq(), 3u);
}

TEST_F(EditTest, EditsThatAreNone) {
  using Adjust = std::function<void(v1::ApplyEditsRequest&)>;
  const std::pair<const char*, Adjust> cases[] = {
      {"request_id", [](auto& r) { r.clear_request_id(); }},
      {"request_id", [](auto& r) { r.set_request_id(std::string(65, 'x')); }},
      {"edits", [](auto& r) { r.clear_edits(); }},
      {"edits[1]", [](auto& r) { r.add_edits(); }},
      {"edits[0].build.placements", [](auto& r) { r.mutable_edits(0)->mutable_build()->add_placements(1); }},
      {"edits[0].build.placements", [](auto& r) { r.mutable_edits(0)->mutable_build()->clear_placements(); }},
      {"edits[0].move.placement", [](auto& r) { r.mutable_edits(0)->mutable_move()->add_placement(1); }},
      {"edits[0].set_sun", [](auto& r) { r.mutable_edits(0)->mutable_set_sun(); }},
      {"edits[0].set_time", [](auto& r) { r.mutable_edits(0)->mutable_set_time(); }},
      {"edits[0].set_time.rate", [](auto& r) { r.mutable_edits(0)->mutable_set_time()->set_rate(-1.0); }},
      {"edits[0].set_sun.daylight.elevation",
       [](auto& r) { r.mutable_edits(0)->mutable_set_sun()->mutable_daylight()->set_elevation(std::nanf("")); }},
  };
  for (const auto& [field, adjust] : cases) {
    auto request = buildRequest("city", "a", 1);
    adjust(request);
    v1::ApplyEditsResponse answer;
    expectFailure(apply(request, answer), Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD, field);
  }
  auto request = buildRequest("city", "a", std::nanf(""));
  v1::ApplyEditsResponse answer;
  EXPECT_EQ(apply(request, answer).status.error_code(), Code::INVALID_ARGUMENT);
  request = buildRequest("atlantis", "a", 1);
  expectFailure(apply(request, answer), Code::NOT_FOUND, v1::ERROR_REASON_UNKNOWN_WORLD, "world");
  EXPECT_EQ(seqOf("city"), 0u);
  expectServing("city");
}

TEST_F(EditTest, TooManyEditsAndTooLargeAMessage) {
  restart([](service::ServerConfig& config) {
    config.limits.world.max_edits_per_batch = 10;
    config.limits.max_request_bytes = 10'000;
  });
  makeWorld("city");
  auto request = buildRequest("city", "a", 1);
  while (request.edits_size() < 11) *request.add_edits() = request.edits(0);
  v1::ApplyEditsResponse answer;
  expectFailure(apply(request, answer), Code::RESOURCE_EXHAUSTED, v1::ERROR_REASON_LIMIT, "edits", "10");
  // A message beyond the limit is refused before any of our code sees it: a status without detail.
  request = buildRequest("city", "a", 1);
  request.mutable_edits(0)->mutable_build()->mutable_placements()->Resize(8 * 1000, 1.0f);
  EXPECT_EQ(apply(request, answer).status.error_code(), Code::RESOURCE_EXHAUSTED);
  EXPECT_EQ(seqOf("city"), 0u);
  expectServing("city");
}

TEST_F(EditTest, QueriesThatAreNone) {
  v1::QueryInstancesRequest query;
  v1::QueryInstancesResponse answer;
  query.set_world("city");
  expectFailure(call(&Stub::QueryInstances, query, answer), Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD,
                "radius");
  query.set_radius(10);
  query.set_page_token("12x");
  expectFailure(call(&Stub::QueryInstances, query, answer), Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD,
                "page_token");
  query.clear_page_token();
  query.set_page_size(10'001);
  expectFailure(call(&Stub::QueryInstances, query, answer), Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD,
                "page_size", "[0, 10000]");
  query.set_page_size(1);
  query.set_min_seq(1);
  expectFailure(call(&Stub::QueryInstances, query, answer), Code::UNAVAILABLE, v1::ERROR_REASON_UNAVAILABLE, "min_seq");
}

}  // namespace
}  // namespace helio::test
