#include "services/gateway/adapter/web_server.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <list>
#include <map>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "services/gateway/core/log_budget.h"

namespace thalweg::gateway {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using tcp = asio::ip::tcp;
using boost::system::error_code;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

namespace {

using Request = http::request<http::empty_body>;
using Response = http::response<http::string_body>;

class Socket;
class Visitor;

/// What a page asks whose socket did not open: whether it may connect, and why not.
constexpr std::string_view kMayConnect = "/may-connect";
constexpr auto kPlainText = "text/plain; charset=utf-8";

/// Since some moment, by a clock that never goes back.
Duration MonotonicNow() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

/// The parts that connections share.
struct Shared {
  const Access access;
  const PageFiles page;
  Hub hub;
  WebServer::Handlers handlers;
  std::map<Hub::ClientId, std::shared_ptr<Socket>> sockets;
  std::list<Visitor*> visitors;  ///< Whoever was silent longest first.

  LogBudget refusal_lines = {};
  LogBudget client_lines = {};

  void FlushAll();
  /// Logs what others have caused, as far as the budget goes.
  static void Log(LogBudget& budget, spdlog::level::level_enum level, const std::string& line) {
    const std::optional<std::uint64_t> left_out = budget.Spend(MonotonicNow());
    if (!left_out) return;
    if (*left_out > 0) spdlog::warn("{} lines of this kind were left out:", *left_out);
    spdlog::log(level, line);
  }
  void ReportWanted() {
    const Hub::WantedChanges changes = hub.TakeWantedChanges(MonotonicNow());
    if (!changes.begun.empty() || !changes.ended.empty()) handlers.wanted(changes);
  }
  void PassCommands(Hub::ClientId client) {
    Session& session = hub.session(client);
    for (const ClientCommand& command : session.TakeCommands())
      handlers.command(client, session.client(), command);
  }
};

/// Address and port of the other end; "" if it is gone.
std::string AddressOf(const tcp::socket& socket) {
  error_code error;
  const tcp::endpoint peer = socket.remote_endpoint(error);
  if (error) return {};
  return peer.address().to_string() + ":" + std::to_string(peer.port());
}

std::string_view View(boost::string_view text) {
  return {text.data(), text.size()};
}

RequestHead HeadOf(const Request& request) {
  return {View(request.target()), View(request[http::field::host]), View(request[http::field::origin]),
          View(request[http::field::authorization]), View(request[http::field::sec_websocket_protocol])};
}

/// A client's WebSocket. At most one frame is being written; what else waits is in the client's session.
class Socket final : public std::enable_shared_from_this<Socket> {
 public:
  Socket(tcp::socket socket, Shared& shared, ClientInfo info)
      : socket_(std::move(socket)), shared_(shared), info_(std::move(info)) {}

  void Accept(const Request& request) {
    socket_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    socket_.set_option(
        websocket::stream_base::decorator([protocol = std::string(ChooseProtocol(HeadOf(request).protocols))](
                                              websocket::response_type& response) {
          response.set(http::field::sec_websocket_protocol, protocol);
        }));
    socket_.read_message_max(kMaxClientFrame);
    socket_.auto_fragment(false);
    socket_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (!error) self->Open();
    });
  }

  void Flush() {
    if (ended_) return;
    Session& session = shared_.hub.session(client_);
    if (writing_) {
      if (session.closing()) CloseEvenUnread();
      return;
    }
    if (session.closing()) return Close(*session.closing());
    std::optional<Frame> frame = session.Next();
    if (!frame) return;
    frame_ = std::move(*frame);
    writing_ = true;
    socket_.binary(frame_.binary);
    std::array<asio::const_buffer, 2> buffers = {asio::buffer(frame_.head), asio::const_buffer()};
    if (frame_.body) buffers[1] = asio::buffer(*frame_.body);
    socket_.async_write(buffers, [self = shared_from_this()](error_code error, std::size_t) {
      self->writing_ = false;
      self->frame_ = {};
      if (error) return self->End();
      self->Flush();
    });
  }

 private:
  void Open() {
    if (shared_.hub.full()) {
      socket_.async_close({websocket::close_code::try_again_later, "too many clients"},
                          [self = shared_from_this()](error_code) {});
      return;
    }
    client_ = shared_.hub.Connect(info_);
    shared_.sockets[client_] = shared_from_this();
    LogClient(" connected (" + info_.name + " from " + info_.address + ", " +
              (info_.no_steering ? "may not steer: " + *info_.no_steering : "may steer") + "), " +
              std::to_string(shared_.sockets.size()) + " in all");
    Read();
    Flush();
  }

  void Read() {
    socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error || self->ended_) return self->End();
      self->OnFrame();
      self->Read();
    });
  }

  void OnFrame() {
    const auto* const data = static_cast<const char*>(buffer_.cdata().data());
    if (socket_.got_text()) {
      shared_.hub.OnText(client_, {data, buffer_.size()}, MonotonicNow());
    } else {
      shared_.hub.OnBinary(client_, {reinterpret_cast<const std::uint8_t*>(data), buffer_.size()},
                           MonotonicNow());
    }
    buffer_.consume(buffer_.size());
    shared_.ReportWanted();
    shared_.PassCommands(client_);
    Flush();
  }

  void Close(const std::string& reason) {
    LogClient(" is closed: " + reason, spdlog::level::warn);
    constexpr std::size_t kLongest = 120;  // of a control frame's 125 octets
    const websocket::close_reason close(websocket::close_code::policy_error, reason.substr(0, kLongest));
    const auto self = shared_from_this();
    Leave();
    socket_.async_close(close, [self](error_code) {});
  }

  /// A client that does not read what is being written would never read why it is closed either.
  void CloseEvenUnread() {
    if (deadline_) return;
    deadline_.emplace(socket_.get_executor(), kLongestClosing);
    deadline_->async_wait([self = shared_from_this()](error_code stopped) {
      if (stopped || self->ended_) return;
      self->LogClient(" is closed: it does not read; " + *self->shared_.hub.session(self->client_).closing(),
                      spdlog::level::warn);
      self->Leave();
      beast::get_lowest_layer(self->socket_).close();
    });
  }

  void End() {
    if (ended_) return;
    LogClient(" left, " + std::to_string(shared_.sockets.size() - 1) + " remain");
    Leave();
  }

  void LogClient(const std::string& text, spdlog::level::level_enum level = spdlog::level::info) {
    Shared::Log(shared_.client_lines, level, "client " + std::to_string(client_) + text);
  }

  void Leave() {
    ended_ = true;
    deadline_.reset();
    shared_.hub.Disconnect(client_);
    const std::shared_ptr<Socket> self = shared_from_this();
    shared_.sockets.erase(client_);
    shared_.ReportWanted();
  }

  static constexpr Duration kLongestClosing = 3s;

  websocket::stream<beast::tcp_stream> socket_;
  Shared& shared_;
  beast::flat_buffer buffer_;
  ClientInfo info_;
  Hub::ClientId client_ = 0;
  std::optional<asio::steady_timer> deadline_;
  Frame frame_;
  bool writing_ = false;
  bool ended_ = false;
};

/// An HTTP connection: answers requests for files until one asks for a WebSocket.
class Visitor final : public std::enable_shared_from_this<Visitor> {
 public:
  Visitor(tcp::socket socket, Shared& shared) : stream_(std::move(socket)), shared_(shared) {
    place_ = shared_.visitors.insert(shared_.visitors.end(), this);
  }
  ~Visitor() { shared_.visitors.erase(place_); }
  Visitor(const Visitor&) = delete;
  Visitor& operator=(const Visitor&) = delete;

  void Read() {
    parser_.emplace();
    parser_->header_limit(kLongestHead);
    stream_.expires_after(20s);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (!error) return self->Answer(self->parser_->release());
      if (error == http::error::header_limit) return self->Refuse({}, {431, "the request is too long"});
      const bool is_gone = error == http::error::end_of_stream || error == http::error::partial_message;
      if (error.category() == make_error_code(http::error::bad_method).category() && !is_gone)
        self->Refuse({}, {400, "this is no HTTP request: " + error.message()});
    });
  }
  void Drop() { stream_.close(); }

 private:
  void Answer(Request request) {
    shared_.visitors.splice(shared_.visitors.end(), shared_.visitors, place_);
    if (websocket::is_upgrade(request)) {
      const std::optional<Refusal> refusal = shared_.access.RefuseSocket(HeadOf(request));
      if (refusal) return Refuse(request, *refusal);
      stream_.expires_never();
      const ClientInfo info = InfoOf(request);  // which needs the socket
      std::make_shared<Socket>(stream_.release_socket(), shared_, info)->Accept(request);
      return;
    }
    if (const auto refusal = shared_.access.RefusePage(HeadOf(request))) return Refuse(request, *refusal);
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      return Refuse(request, {405, "only GET and HEAD are answered"});
    }
    if (PathOf(View(request.target())) == kMayConnect) {
      const std::optional<Refusal> refusal = shared_.access.RefuseClient(HeadOf(request));
      return Send(request, refusal ? refusal->http_status : 200, kPlainText,
                  refusal ? refusal->reason : "yes");
    }
    const auto file = shared_.page.find(PathOf(View(request.target())));
    if (file == shared_.page.end()) return Refuse(request, {404, "there is no such file"});
    Send(request, 200, file->second.media_type, file->second.content);
  }

  ClientInfo InfoOf(const Request& request) {
    ClientInfo info;
    info.name = NameOfClient(View(request.target()));
    info.address = AddressOf(stream_.socket());
    const std::string ip = info.address.substr(0, info.address.rfind(':'));
    info.no_steering = shared_.access.RefuseSteering(ip);
    return info;
  }

  void Refuse(const Request& request, const Refusal& refusal) {
    if (refusal.http_status != 404) {
      Shared::Log(shared_.refusal_lines, spdlog::level::warn, "refused a request: " + refusal.reason);
      shared_.hub.CountRefusedRequest(refusal.reason);
    }
    Send(request, refusal.http_status, kPlainText, refusal.reason + "\n");
  }

  void Send(const Request& request, int status, const std::string& media_type, const std::string& content) {
    response_.emplace(http::int_to_status(static_cast<unsigned>(status)), request.version());
    response_->set(http::field::content_type, media_type);
    response_->set(http::field::cache_control, "no-cache");
    response_->set("X-Content-Type-Options", "nosniff");
    response_->set("Referrer-Policy", "no-referrer");
    response_->set("Content-Security-Policy",
                   "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
                   "connect-src 'self' ws: wss:; frame-ancestors 'none'");
    response_->keep_alive(request.keep_alive() && status == 200);
    response_->body() = content;
    response_->prepare_payload();
    if (request.method() == http::verb::head) response_->body().clear();
    http::async_write(stream_, *response_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return;
      if (self->response_->need_eof()) {
        error_code ignored;
        self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
        return self->Drain(kMostDrained);
      }
      self->Read();
    });
  }

  /// Reads what the other end still sends, at most so many bytes: a socket that is closed with unread input
  /// resets the connection, and the answer may be lost with it.
  void Drain(std::size_t most) {
    buffer_.clear();
    stream_.expires_after(5s);
    stream_.async_read_some(buffer_.prepare(4096),
                            [self = shared_from_this(), most](error_code error, std::size_t count) {
                              if (!error && count < most) self->Drain(most - count);
                            });
  }

  static constexpr std::uint32_t kLongestHead = 8192;
  static constexpr std::size_t kMostDrained = 1 << 20;

  beast::tcp_stream stream_;
  Shared& shared_;
  std::list<Visitor*>::iterator place_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::optional<Response> response_;
};

void Shared::FlushAll() {
  // A flush may end a client, which removes it from the map
  for (auto next = sockets.begin(); next != sockets.end();) (next++)->second->Flush();
}

tcp::endpoint EndpointOf(const ListenOptions& options) {
  error_code error;
  const auto address = asio::ip::make_address(options.address, error);
  if (error) {
    throw std::runtime_error("address \"" + options.address + "\" is not an IPv4 or IPv6 address");
  }
  if (options.port < 0 || options.port > 65535) {
    throw std::runtime_error("port " + std::to_string(options.port) + " is not in 0 to 65535");
  }
  return {address, static_cast<unsigned short>(options.port)};
}

}  // namespace

struct WebServer::State {
  State(const ListenOptions& options, Hub::Options content, PageFiles page, Handlers handlers)
      : shared{Access(options.address, options.token, options.read_only, options.origins),
               std::move(page),
               Hub(std::move(content)),
               std::move(handlers),
               {},
               {}},
        acceptor(context),
        pause(context),
        second(context) {
    tcp::endpoint endpoint = EndpointOf(options);
    const int last = std::min(options.port + options.more_ports, 65535);
    for (int port = options.port; !Listen(endpoint, port < last); ++port) {
      spdlog::warn("port {} is in use, by another gateway perhaps: trying the next", port);
      endpoint.port(static_cast<unsigned short>(port + 1));
    }
  }

  /// Returns false if others use the port and that `is_tolerable`.
  bool Listen(const tcp::endpoint& endpoint, bool is_tolerable) {
    try {
      if (acceptor.is_open()) acceptor.close();
      acceptor.open(endpoint.protocol());
      acceptor.set_option(asio::socket_base::reuse_address(true));
      acceptor.bind(endpoint);
      acceptor.listen();
      return true;
    } catch (const boost::system::system_error& error) {
      if (is_tolerable && error.code() == asio::error::address_in_use) return false;
      throw std::runtime_error("cannot listen on " + endpoint.address().to_string() + " port " +
                               std::to_string(endpoint.port()) + ": " + error.code().message());
    }
  }

  void AcceptNext() {
    acceptor.async_accept([this](error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      constexpr std::size_t kMaxVisitors = 64;
      if (!error) {
        // A browser asks as soon as it is connected, so whoever holds a place in silence makes way for it.
        if (shared.visitors.size() >= kMaxVisitors) shared.visitors.front()->Drop();
        error_code ignored;
        socket.set_option(tcp::no_delay(true), ignored);
        std::make_shared<Visitor>(std::move(socket), shared)->Read();
      }
      if (!error) return AcceptNext();
      pause.expires_after(100ms);  // e.g. no free file descriptor
      pause.async_wait([this](error_code stopped) {
        if (!stopped) AcceptNext();
      });
    });
  }

  /// Topics that nobody wants are closed after a while, in which nothing else may happen.
  void ReportWantedEverySecond() {
    second.expires_after(1s);
    second.async_wait([this](error_code stopped) {
      if (stopped) return;
      shared.ReportWanted();
      ReportWantedEverySecond();
    });
  }

  Shared shared;
  asio::io_context context{1};
  tcp::acceptor acceptor;
  asio::steady_timer pause, second;
  std::thread thread;
};

WebServer::WebServer(const ListenOptions& options, Hub::Options content, PageFiles page, Handlers handlers)
    : state_(std::make_unique<State>(options, std::move(content), std::move(page), std::move(handlers))) {
  state_->AcceptNext();
  state_->ReportWantedEverySecond();
  state_->thread = std::thread([this] { state_->context.run(); });
}

WebServer::~WebServer() {
  state_->context.stop();
  state_->thread.join();
  state_->shared.sockets.clear();
}

int WebServer::port() const {
  return state_->acceptor.local_endpoint().port();
}

void WebServer::Post(std::function<void(Hub&)> task) {
  asio::post(state_->context, [this, task = std::move(task)] {
    task(state_->shared.hub);
    state_->shared.FlushAll();
  });
}

}  // namespace thalweg::gateway
