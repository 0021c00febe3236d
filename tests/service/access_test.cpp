// Who gets in, and who does not. What a method needs is read from the proto: a new one without a scope fails here.
#include <google/protobuf/descriptor.h>
#include <grpcpp/generic/generic_stub.h>

#include <heliograph/v1/access.grpc.pb.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "access/key_folder.h"
#include "access/private_file.h"
#include "fixture.h"

namespace helio::test {
namespace {

using namespace std::chrono_literals;
using Code = grpc::StatusCode;
using access::Scope;

/// Every method of heliograph.v1.
std::vector<const google::protobuf::MethodDescriptor*> allMethods() {
  std::vector<const google::protobuf::MethodDescriptor*> methods;
  for (const auto* file : {v1::GetServerInfoRequest::descriptor()->file(), v1::ViewerMessage::descriptor()->file(),
                           v1::RenderRequest::descriptor()->file(), v1::TelemetrySample::descriptor()->file(),
                           v1::Token::descriptor()->file()})
    for (int s = 0; s < file->service_count(); ++s)
      for (int m = 0; m < file->service(s)->method_count(); ++m) methods.push_back(file->service(s)->method(m));
  return methods;
}

class AccessTest : public ServiceTest {
 protected:
  AccessTest() : keys_(folder_ / "keys") {
    EXPECT_TRUE(keys_.create({"localhost", "127.0.0.1"}).ok());
    admin_ = token(Scope::admin);
    restart([&](service::ServerConfig& config) { config.keys = keys_.path(); });
    use(admin_);
    makeWorld("city");
  }

  std::string token(Scope scope, std::set<std::string> worlds = {}, int64_t lifetime = 0) {
    const auto created = keys_.tokens().create({"test", scope, std::move(worlds), lifetime});
    EXPECT_TRUE(created.ok()) << created.error().message;
    newest_id_ = created->token.id;
    return created->text;
  }

  std::shared_ptr<grpc::Channel> channelWith(const std::string& token) {
    grpc::SslCredentialsOptions tls;
    tls.pem_root_certs = *access::readFile(keys_.authorityCertificate());
    auto credentials = grpc::SslCredentials(tls);
    if (!token.empty())
      credentials = grpc::CompositeChannelCredentials(credentials, grpc::AccessTokenCredentials(token));
    // A connection of its own: a shared one would not shake hands again.
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return grpc::CreateCustomChannel(server_->address(), credentials, arguments);
  }
  void use(const std::string& token) {
    channel_ = channelWith(token);
    worlds_ = v1::WorldService::NewStub(channel_);
    viewers_ = v1::ViewerService::NewStub(channel_);
    renders_ = v1::RenderService::NewStub(channel_);
    telemetry_ = v1::TelemetryService::NewStub(channel_);
    tokens_ = v1::AccessService::NewStub(channel_);
  }

  /// Calls any method with an empty request, as generic bytes; streams of the client are ended at once.
  Ended callEmpty(const google::protobuf::MethodDescriptor& method, const std::string& token) {
    grpc::GenericStub stub(channelWith(token));
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + 20s);
    grpc::CompletionQueue queue;
    const auto call = stub.PrepareCall(&context, "/" + method.service()->full_name() + "/" + method.name(), &queue);
    const auto wait = [&queue] {
      void* tag = nullptr;
      bool ok = false;
      queue.Next(&tag, &ok);
      return ok;
    };
    call->StartCall(nullptr);
    wait();
    const grpc::Slice nothing;
    call->WriteLast({&nothing, 1}, {}, nullptr);
    wait();
    grpc::ByteBuffer answer;
    for (bool more = true; more;) {
      call->Read(&answer, nullptr);
      more = wait();
      if (more) context.TryCancel();  // it was let in: more is not asked
    }
    grpc::Status status;
    call->Finish(&status, nullptr);
    wait();
    queue.Shutdown();
    while (wait()) {}
    return {status, detailOf(context)};
  }

  const access::KeyFolder keys_;
  std::string admin_, newest_id_;
  std::unique_ptr<v1::AccessService::Stub> tokens_;
};

TEST_F(AccessTest, EveryMethodSaysWhatItNeeds) {
  const auto methods = allMethods();
  EXPECT_GE(methods.size(), 14u);
  for (const auto* method : methods) {
    EXPECT_TRUE(method->options().HasExtension(v1::needs)) << method->full_name();
    EXPECT_NE(method->options().GetExtension(v1::needs).scope(), v1::SCOPE_UNSPECIFIED) << method->full_name();
  }
}

TEST_F(AccessTest, EveryMethodRefusesEveryMissingScope) {
  const std::string without, unknown = "helio_0123456789ab_" + std::string(64, '0'), view = token(Scope::view),
                             edit = token(Scope::edit);
  std::this_thread::sleep_for(1500ms);  // the file is looked at every second
  for (const auto* method : allMethods()) {
    SCOPED_TRACE(method->full_name());
    for (const auto& bad : {without, unknown}) {
      const auto refused = callEmpty(*method, bad);
      EXPECT_EQ(refused.status.error_code(), Code::UNAUTHENTICATED) << refused.status.error_message();
      EXPECT_EQ(refused.detail.reason(), v1::ERROR_REASON_UNAUTHENTICATED);
    }
    const auto needed = method->options().GetExtension(v1::needs).scope();
    for (const auto& [scope, text] : {std::pair(v1::SCOPE_VIEW, view), {v1::SCOPE_EDIT, edit}}) {
      const auto called = callEmpty(*method, text);
      if (scope < needed) {
        EXPECT_EQ(called.status.error_code(), Code::PERMISSION_DENIED) << called.status.error_message();
        EXPECT_EQ(called.detail.reason(), v1::ERROR_REASON_FORBIDDEN);
      } else {
        EXPECT_NE(called.status.error_code(), Code::PERMISSION_DENIED) << called.status.error_message();
        EXPECT_NE(called.status.error_code(), Code::UNAUTHENTICATED) << called.status.error_message();
      }
    }
  }
}

TEST_F(AccessTest, ATokenForOneWorldIsForNoOther) {
  makeWorld("other");
  const std::string bound = token(Scope::admin, {"city"});
  std::this_thread::sleep_for(1500ms);
  use(bound);
  for (const auto* method : allMethods()) {
    SCOPED_TRACE(method->full_name());
    if (!method->options().GetExtension(v1::needs).server_wide()) continue;
    EXPECT_EQ(callEmpty(*method, bound).status.error_code(), Code::PERMISSION_DENIED);
  }
  v1::ListWorldsResponse list;
  ASSERT_TRUE(call(&v1::WorldService::Stub::ListWorlds, {}, list).status.ok());
  ASSERT_EQ(list.worlds_size(), 1);
  EXPECT_EQ(list.worlds(0).world(), "city");

  v1::GetWorldRequest get;
  v1::World world;
  get.set_world("city");
  EXPECT_TRUE(call(&v1::WorldService::Stub::GetWorld, get, world).status.ok());
  // A world that is there and one that is not: the same answer.
  for (const char* name : {"other", "nowhere"}) {
    get.set_world(name);
    expectFailure(call(&v1::WorldService::Stub::GetWorld, get, world), Code::PERMISSION_DENIED,
                  v1::ERROR_REASON_FORBIDDEN, "authorization", "city");
    Viewer viewer(*viewers_, name, 32, 16);
    expectFailure(viewer.end(), Code::PERMISSION_DENIED, v1::ERROR_REASON_FORBIDDEN, "authorization", "city");
    grpc::ClientContext watch_context;
    v1::WatchTelemetryRequest watch;
    watch.set_world(name);
    v1::TelemetrySample sample;
    const auto stream = telemetry_->Watch(&watch_context, watch);
    EXPECT_FALSE(stream->Read(&sample));
    EXPECT_EQ(stream->Finish().error_code(), Code::PERMISSION_DENIED);
    v1::CreateWorldRequest create;
    create.set_world(name);
    create.mutable_gltf()->set_path("triangle.gltf");
    EXPECT_EQ(call(&v1::WorldService::Stub::CreateWorld, create, world).status.error_code(), Code::PERMISSION_DENIED);
    v1::RenderRequest shot;
    shot.set_world(name);
    grpc::ClientContext shot_context;
    v1::RenderEvent event;
    const auto shots = renders_->Render(&shot_context, shot);
    EXPECT_FALSE(shots->Read(&event));
    EXPECT_EQ(shots->Finish().error_code(), Code::PERMISSION_DENIED);
  }
  v1::CreateWorldRequest nameless;
  nameless.mutable_gltf()->set_path("triangle.gltf");
  EXPECT_EQ(call(&v1::WorldService::Stub::CreateWorld, nameless, world).status.error_code(), Code::PERMISSION_DENIED);

  grpc::ClientContext context;
  v1::TelemetrySample sample;
  const auto stream = telemetry_->Watch(&context, {});
  ASSERT_TRUE(stream->Read(&sample));
  ASSERT_EQ(sample.worlds_size(), 1);
  EXPECT_EQ(sample.worlds(0).world(), "city");
  context.TryCancel();
  stream->Finish();
  expectServing("city");
}

TEST_F(AccessTest, AnotherTokensPictureIsForAdministrators) {
  const std::string ann = token(Scope::edit), ben = token(Scope::edit);
  std::this_thread::sleep_for(1500ms);
  use(ann);
  Viewer viewer(*viewers_, "city", 32, 16);
  const uint64_t id = viewer.welcome().viewer();
  std::atomic<bool> looking = true;
  std::thread looks([&] {
    while (looking) viewer.frame();
  });
  const auto measure = [&](const std::string& with) {
    use(with);
    grpc::ClientContext context;
    v1::MeasureAccuracyRequest request;
    request.set_world("city");
    request.set_viewer(id);
    request.set_samples(2);
    const auto stream = renders_->MeasureAccuracy(&context, request);
    for (v1::AccuracyEvent event; stream->Read(&event);) {}
    Ended ended;
    ended.status = stream->Finish();
    ended.detail = detailOf(context);
    return ended;
  };
  expectFailure(measure(ben), Code::PERMISSION_DENIED, v1::ERROR_REASON_FORBIDDEN, "authorization", "admin");
  EXPECT_TRUE(measure(ann).status.ok());
  const auto by_admin = measure(admin_);
  EXPECT_TRUE(by_admin.status.ok()) << by_admin.status.error_message();
  looking = false;
  looks.join();
}

TEST_F(AccessTest, ARevokedTokensStreamsEnd) {
  grpc::ClientContext create_context, revoke_context, watch_context;
  v1::CreateTokenRequest create;
  create.set_name("Ann's laptop");
  create.set_scope(v1::SCOPE_VIEW);
  v1::CreateTokenResponse created;
  ASSERT_TRUE(tokens_->CreateToken(&create_context, create, &created).ok());
  auto admin = std::move(tokens_);
  use(created.secret());  // holds at once
  v1::ServerInfo info;
  ASSERT_TRUE(call(&v1::WorldService::Stub::GetServerInfo, {}, info).status.ok());
  EXPECT_EQ(info.token().name(), "Ann's laptop");
  Viewer viewer(*viewers_, "city", 32, 16);
  viewer.frame();
  v1::TelemetrySample sample;
  const auto watch = telemetry_->Watch(&watch_context, {});
  ASSERT_TRUE(watch->Read(&sample));

  v1::RevokeTokenRequest revoke;
  revoke.set_id(created.token().id());
  v1::RevokeTokenResponse revoked;
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(admin->RevokeToken(&revoke_context, revoke, &revoked).ok());
  expectFailure(viewer.end(), Code::UNAUTHENTICATED, v1::ERROR_REASON_UNAUTHENTICATED, "authorization");
  while (watch->Read(&sample)) {}
  EXPECT_EQ(watch->Finish().error_code(), Code::UNAUTHENTICATED);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 5s);  // what the manual promises, not a speed
  EXPECT_EQ(call(&v1::WorldService::Stub::GetServerInfo, {}, info).status.error_code(), Code::UNAUTHENTICATED);
  use(admin_);
  expectServing("city");
}

TEST_F(AccessTest, TokensThatChangeInTheFileHoldWithoutARestart) {
  const std::string brief = token(Scope::view, {}, 2);
  const std::string gone = token(Scope::view);
  const std::string id = newest_id_;
  std::this_thread::sleep_for(1200ms);
  use(gone);
  Viewer viewer(*viewers_, "city", 32, 16);
  viewer.frame();
  ASSERT_TRUE(keys_.tokens().revoke(id).ok());
  expectFailure(viewer.end(), Code::UNAUTHENTICATED, v1::ERROR_REASON_UNAUTHENTICATED, "authorization");
  std::this_thread::sleep_for(1s);
  use(brief);
  v1::ServerInfo info;
  const auto expired = call(&v1::WorldService::Stub::GetServerInfo, {}, info);
  EXPECT_EQ(expired.status.error_code(), Code::UNAUTHENTICATED);
  EXPECT_THAT(expired.status.error_message(), testing::HasSubstr("expired"));

  // A file that is damaged changes nothing.
  std::ofstream(keys_.tokens().path()) << "not json";
  std::this_thread::sleep_for(1500ms);
  use(admin_);
  EXPECT_TRUE(call(&v1::WorldService::Stub::GetServerInfo, {}, info).status.ok());
}

TEST_F(AccessTest, ARenewedCertificateIsShownWithoutARestart) {
  v1::ServerInfo info;
  ASSERT_TRUE(keys_.renew({"elsewhere.example"}).ok());
  eventually(
      [&] {
        use(admin_);
        return !call(&v1::WorldService::Stub::GetServerInfo, {}, info).status.ok();
      },
      "the new certificate, which is not for 127.0.0.1, is shown");
  ASSERT_TRUE(keys_.renew({"127.0.0.1"}).ok());
  eventually(
      [&] {
        use(admin_);
        return call(&v1::WorldService::Stub::GetServerInfo, {}, info).status.ok();
      },
      "the next one is");
}

TEST_F(AccessTest, PlainTextAndOtherAuthoritiesGetNowhere) {
  v1::ServerInfo info;
  worlds_ = v1::WorldService::NewStub(grpc::CreateChannel(server_->address(), grpc::InsecureChannelCredentials()));
  EXPECT_EQ(call(&v1::WorldService::Stub::GetServerInfo, {}, info).status.error_code(), Code::UNAVAILABLE);
  const access::KeyFolder stranger(folder_ / "stranger");
  ASSERT_TRUE(stranger.create({"127.0.0.1"}).ok());
  grpc::SslCredentialsOptions tls;
  tls.pem_root_certs = *access::readFile(stranger.authorityCertificate());
  worlds_ = v1::WorldService::NewStub(grpc::CreateChannel(server_->address(), grpc::SslCredentials(tls)));
  EXPECT_EQ(call(&v1::WorldService::Stub::GetServerInfo, {}, info).status.error_code(), Code::UNAVAILABLE);
}

TEST_F(ServiceTest, AServerWithUnusableKeysRefusesToStart) {
  const auto refusal = [&] {
    service::ServerConfig config;
    config.address = "127.0.0.1:0";
    config.keys = folder_ / "keys";
    const auto server = service::Server::start(config, renderer_, *log_);
    EXPECT_FALSE(server.ok());
    return server.ok() ? "" : server.error().message;
  };
  const access::KeyFolder keys(folder_ / "keys");
  EXPECT_THAT(refusal(), testing::HasSubstr("heliographd init"));
  ASSERT_TRUE(keys.create({"localhost"}).ok());
  EXPECT_THAT(refusal(), testing::HasSubstr("--new-token"));
  ASSERT_TRUE(keys.tokens().create({"admin", Scope::admin, {}, 0}).ok());
  std::filesystem::permissions(keys.key(), std::filesystem::perms(0644));
  EXPECT_THAT(refusal(), testing::HasSubstr("chmod 600"));
}

}  // namespace
}  // namespace helio::test
