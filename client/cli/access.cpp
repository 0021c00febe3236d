// helio login, helio logout, helio token: who may do what.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>

#include "cli/command.h"

namespace helio::cli {
namespace {

const char* nameOf(v1::Scope scope) {
  switch (scope) {
    case v1::SCOPE_VIEW:
      return "view";
    case v1::SCOPE_EDIT:
      return "edit";
    case v1::SCOPE_ADMIN:
      return "admin";
    default:
      return "none";
  }
}

v1::Scope parseScope(const std::string& name) {
  for (const auto scope : {v1::SCOPE_VIEW, v1::SCOPE_EDIT, v1::SCOPE_ADMIN})
    if (name == nameOf(scope)) return scope;
  throw Stop{"--scope is \"" + name + "\"; give view, edit or admin"};
}

std::string dayOf(int64_t seconds) {
  if (seconds == 0) return "never";
  const std::time_t time = seconds;
  std::tm utc{};
  gmtime_r(&time, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d", &utc);
  return text;
}

std::string worldsOf(const v1::Token& token) {
  std::string text;
  for (const auto& world : token.worlds()) text += (text.empty() ? "" : ",") + world;
  return text.empty() ? "every world" : text;
}

Json describe(const v1::Token& token) {
  return {{"id", token.id()},
          {"name", token.name()},
          {"scope", nameOf(token.scope())},
          {"worlds", std::vector<std::string>(token.worlds().begin(), token.worlds().end())},
          {"created", token.created()},
          {"expires", token.expires()}};
}

std::string readAuthority(const std::string& path) {
  std::ifstream file(path);
  std::stringstream pem;
  pem << file.rdbuf();
  if (!file) throw Stop{"cannot read --ca " + path};
  return pem.str();
}

struct LoginOptions {
  std::string server, fingerprint, authority, token;
};

void login(const LoginOptions& options) {
  if (options.fingerprint.empty() == options.authority.empty())
    throw Stop{"give either --ca-sha256 FINGERPRINT or --ca FILE, as heliographd init printed it"};
  client::Credentials credentials;
  credentials.token = options.token;
  if (options.token == "-" && !std::getline(std::cin, credentials.token))
    throw Stop{"--token - reads the token from standard input, where there is none"};
  credentials.authority = options.authority.empty() ? get(client::fetchAuthority(options.server, options.fingerprint))
                                                    : readAuthority(options.authority);
  // Kept only when the server lets us in with it.
  client::Connection connection(options.server, credentials);
  const auto info = get(connection.serverInfo());
  const client::CredentialStore store;
  get(store.keep(options.server, credentials));
  std::printf("logged in to %s as \"%s\", scope %s, %s; kept in %s\n", options.server.c_str(),
              info.token().name().c_str(), nameOf(info.token().scope()), worldsOf(info.token()).c_str(),
              store.path().c_str());
}

struct CreateOptions {
  std::string name, scope = "view";
  std::vector<std::string> worlds;
  double days = 0;
};

void create(const Common& common, const CreateOptions& options) {
  client::Connection connection(common.server);
  v1::CreateTokenRequest request;
  request.set_name(options.name);
  request.set_scope(parseScope(options.scope));
  for (const auto& world : options.worlds) request.add_worlds(world);
  if (options.days > 0) request.set_lifetime(std::max<int64_t>(1, static_cast<int64_t>(options.days * 86'400)));
  const auto created = get(connection.createToken(request));
  if (common.json) {
    Json document = {{"schema", "heliograph.token/1"}};
    document.update(describe(created.token()));
    document["token"] = created.secret();
    return print(document);
  }
  // Standard output has the token alone, for scripts.
  std::fprintf(stderr, "token %s, scope %s, %s, expires %s; it is shown this once:\n", created.token().id().c_str(),
               nameOf(created.token().scope()), worldsOf(created.token()).c_str(),
               dayOf(created.token().expires()).c_str());
  std::printf("%s\n", created.secret().c_str());
}

void list(const Common& common) {
  client::Connection connection(common.server);
  const auto tokens = get(connection.tokens());
  if (common.json) {
    Json document = {{"schema", "heliograph.tokens/1"}, {"tokens", Json::array()}};
    for (const auto& token : tokens) document["tokens"].push_back(describe(token));
    return print(document);
  }
  for (const auto& token : tokens)
    std::printf("%s  %-6s %-24s made %s, expires %s  %s\n", token.id().c_str(), nameOf(token.scope()),
                token.name().c_str(), dayOf(token.created()).c_str(), dayOf(token.expires()).c_str(),
                worldsOf(token).c_str());
}

}  // namespace

void addLogin(CLI::App& app, Common& common) {
  auto options = std::make_shared<LoginOptions>();
  auto* login_command = app.add_subcommand("login", "Keep the credentials for a server that asks for tokens.");
  login_command->footer(R"(Examples:
  helio login example.org:7700 --ca-sha256 5d0c... --token helio_...   (the line that heliographd init prints)
  helio login example.org:7700 --ca ca.crt --token - < token.txt       (keeps the token out of the shell's history))");
  login_command->add_option("server", options->server, "host:port")->required();
  login_command->add_option("--ca-sha256", options->fingerprint, "SHA-256 of the authority's certificate");
  login_command->add_option("--ca", options->authority, "file with the authority's certificate");
  login_command->add_option("--token", options->token, "the token; - reads it from standard input")->required();
  login_command->callback([options] { login(*options); });

  auto* logout = app.add_subcommand("logout", "Forget the credentials for a server.");
  addCommon(*logout, common, false);
  logout->callback([&common] { get(client::CredentialStore().forget(common.server)); });
}

void addToken(CLI::App& app, Common& common) {
  auto* token = app.add_subcommand("token", "Hand out, list and revoke tokens (scope admin).");
  token->require_subcommand(1);
  token->footer(R"(Examples:
  helio token create "Ann" --scope edit --world city --days 30
  helio token list
  helio token revoke 4f2a91c07b3e)");
  auto options = std::make_shared<CreateOptions>();
  auto* make = token->add_subcommand("create", "Make a token; standard output has it, this once.");
  addCommon(*make, common);
  make->add_option("name", options->name, "whose it is, for people")->required();
  make->add_option("--scope", options->scope, "view, edit (and view), admin (all)")->capture_default_str();
  make->add_option("--world", options->worlds, "only for this world; may be repeated");
  make->add_option("--days", options->days, "expires after so many; 0: never")->check(CLI::Range(0.0, 36'600.0));
  make->callback([&common, options] { create(common, *options); });

  auto* all = token->add_subcommand("list", "All tokens of the server, without their secrets.");
  addCommon(*all, common);
  all->callback([&common] { list(common); });

  auto id = std::make_shared<std::string>();
  auto* revoke = token->add_subcommand("revoke", "End a token: its calls fail, its streams end within 5 s.");
  addCommon(*revoke, common, false);
  revoke->add_option("id", *id, "the token's id, as list shows it")->required();
  revoke->callback([&common, id] {
    client::Connection connection(common.server);
    get(connection.revokeToken(*id));
  });
}

}  // namespace helio::cli
