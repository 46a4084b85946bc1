// Bogacki-Shampine 3(2) with plain sgn for the drum in reading `consistent`, sixteen trajectories in a group, written by
// hand with vector extensions: what the generated kernel is measured against. Also a loop of fused products for the peak.
// Built by ensembles.py: g++ -O3 -march=native -ffp-contract=fast -fno-math-errno -fno-trapping-math -shared -fPIC
#include <cstdint>
#include <cstring>

typedef double Vec __attribute__((vector_size(64)));
typedef int64_t Int __attribute__((vector_size(64)));
#define INLINE static inline __attribute__((always_inline))

struct D { Vec a, b; };  // sixteen doubles; two independent registers hide each other's latency
struct M { Int a, b; };

INLINE Vec all(double x) { return Vec{} + x; }
INLINE D spread(double x) { return {all(x), all(x)}; }
INLINE D operator+(D x, D y) { return {x.a + y.a, x.b + y.b}; }
INLINE D operator-(D x, D y) { return {x.a - y.a, x.b - y.b}; }
INLINE D operator*(D x, D y) { return {x.a * y.a, x.b * y.b}; }
INLINE D operator/(D x, D y) { return {x.a / y.a, x.b / y.b}; }
INLINE D operator*(double x, D y) { return {x * y.a, x * y.b}; }
INLINE M operator<(D x, D y) { return {x.a < y.a, x.b < y.b}; }
INLINE M operator<=(D x, D y) { return {x.a <= y.a, x.b <= y.b}; }
INLINE M operator>=(D x, D y) { return {x.a >= y.a, x.b >= y.b}; }
INLINE M operator&(M x, M y) { return {x.a & y.a, x.b & y.b}; }
INLINE M operator|(M x, M y) { return {x.a | y.a, x.b | y.b}; }
INLINE M operator~(M x) { return {~x.a, ~x.b}; }
INLINE D where(M m, D x, D y) { return {m.a ? x.a : y.a, m.b ? x.b : y.b}; }
INLINE D larger(D x, D y) { return {x.a > y.a ? x.a : y.a, x.b > y.b ? x.b : y.b}; }
INLINE D smaller(D x, D y) { return {x.a < y.a ? x.a : y.a, x.b < y.b ? x.b : y.b}; }
INLINE D size(D x) { return larger(x, spread(0.0) - x); }
INLINE D load(const double* p) { D x; std::memcpy(&x, p, sizeof x); return x; }
INLINE void store(double* p, D x) { std::memcpy(p, &x, sizeof x); }

INLINE Vec rough(Vec x, double power) {  // x^power to a few per cent, by the bits of exponent and mantissa
    const double one = double(int64_t(1023) << 52);
    Vec whole = __builtin_convertvector((Int)x, Vec);
    return (Vec)__builtin_convertvector((whole - one) * power + one, Int);
}

enum { K00, K01, K10, K11, C0, C1, P00, P01, P10, P11, T00, T01, T10, T11, N00, N01, N10, N11, L0, L1, V0, V1, F0, F1,
       MU0, SL0, FL0, MU1, SL1, FL1, Q0, Q1, U0, U1, A0, A1, A2, A3, RTOL, LARGEST, LEAST, FIRST, GIVEN };
enum { T = GIVEN, H, CAUTIOUS, TRIED, TAKEN, X0, X1, Y0, Y1, B0, B1, JOB, ALIVE, ROWS };

struct Pair { D x, y; };

INLINE D friction(D v, D n, D mu, D slope, D floor) {
    D value = larger(mu + slope * size(v), floor) * n;
    D zero = spread(0.0);
    auto turned = [](Vec x, Vec by) { return (Vec)((Int)x ^ ((Int)by & (Int{} + INT64_MIN))); };  // by the bit of the sign
    return where(M{v.a == zero.a, v.b == zero.b}, zero, D{turned(value.a, v.a), turned(value.b, v.b)});
}

INLINE Pair rates(const double* g, D q0, D q1, D v0, D v1) {
    auto r = [&](int k) { return load(g + 16 * k); };
    D f0 = friction(r(V0) - r(T00) * v0 - r(T01) * v1, r(L0) + r(N00) * q0 + r(N01) * q1, r(MU0), r(SL0), r(FL0));
    D f1 = friction(r(V1) - r(T10) * v0 - r(T11) * v1, r(L1) + r(N10) * q0 + r(N11) * q1, r(MU1), r(SL1), r(FL1));
    return {r(F0) - r(K00) * q0 - r(K01) * q1 - r(C0) * v0 + r(P00) * f0 + r(P10) * f1,
            r(F1) - r(K10) * q0 - r(K11) * q1 - r(C1) * v1 + r(P01) * f0 + r(P11) * f1};
}

INLINE unsigned bits(M m) {
    unsigned out = 0;
    for (int i = 0; i < 8; i++) out |= (unsigned(m.a[i] & 1) << i) | (unsigned(m.b[i] & 1) << (8 + i));
    return out;
}

INLINE bool any(M m) {
    Int x = m.a | m.b;
    return (x[0] | x[1] | x[2] | x[3] | x[4] | x[5] | x[6] | x[7]) != 0;
}

static void refill(double* g, int lane, const double* table, int64_t& next, int64_t total) {
    if (next >= total) { g[16 * ALIVE + lane] = 0.0; g[16 * H + lane] = 0.0; return; }
    const double* given = table + next * GIVEN;
    for (int k = 0; k < GIVEN; k++) g[16 * k + lane] = given[k];
    for (int k = GIVEN; k < ROWS; k++) g[16 * k + lane] = 0.0;
    for (int k = 0; k < 4; k++) g[16 * (X0 + k) + lane] = given[Q0 + k];
    g[16 * H + lane] = given[FIRST];
    g[16 * ALIVE + lane] = 1.0;
    g[16 * JOB + lane] = double(next++);
    D q0 = load(g + 16 * X0), q1 = load(g + 16 * X1), v0 = load(g + 16 * Y0), v1 = load(g + 16 * Y1);
    Pair a = rates(g, q0, q1, v0, v1);
    double both[2][16];
    store(both[0], a.x);
    store(both[1], a.y);
    g[16 * B0 + lane] = both[0][lane];
    g[16 * B1 + lane] = both[1][lane];
}

INLINE int step(double* g, double end, double most, const double* table, int64_t& next, int64_t total, double* out) {
    auto r = [&](int k) { return load(g + 16 * k); };
    D t = r(T), h0 = r(H), rest = spread(end) - t;
    M last = h0 >= 0.999999999999 * rest;
    D h = where(last, rest, h0);
    D q0 = r(X0), q1 = r(X1), v0 = r(Y0), v1 = r(Y1), a0 = r(B0), a1 = r(B1);
    D h2 = 0.5 * h, h3 = 0.75 * h, w1 = (2.0 / 9) * h, w2 = (1.0 / 3) * h, w3 = (4.0 / 9) * h;
    D s0 = v0 + h2 * a0, s1 = v1 + h2 * a1;
    Pair b = rates(g, q0 + h2 * v0, q1 + h2 * v1, s0, s1);
    D u0 = v0 + h3 * b.x, u1 = v1 + h3 * b.y;
    Pair c = rates(g, q0 + h3 * s0, q1 + h3 * s1, u0, u1);
    D x0 = q0 + w1 * v0 + w2 * s0 + w3 * u0, x1 = q1 + w1 * v1 + w2 * s1 + w3 * u1;
    D y0 = v0 + w1 * a0 + w2 * b.x + w3 * c.x, y1 = v1 + w1 * a1 + w2 * b.y + w3 * c.y;
    Pair d = rates(g, x0, x1, y0, y1);
    auto error = [](D k1, D k2, D k3, D k4) {
        return (5.0 / 72) * k1 + (-1.0 / 12) * k2 + (-1.0 / 9) * k3 + (1.0 / 8) * k4; };
    D rtol = r(RTOL);
    auto scale = [&](int k, D old, D now) { D s = r(k) + rtol * larger(size(old), size(now)); return s * s; };
    D e0 = error(v0, s0, u0, y0), e1 = error(v1, s1, u1, y1), e2 = error(a0, b.x, c.x, d.x), e3 = error(a1, b.y, c.y, d.y);
    D z0 = scale(A0, q0, x0), z1 = scale(A1, q1, x1), z2 = scale(A2, v0, y0), z3 = scale(A3, v1, y1);
    D z01 = z0 * z1, z23 = z2 * z3;
    D above = (e0 * e0 * z1 + e1 * e1 * z0) * z23 + (e2 * e2 * z3 + e3 * e3 * z2) * z01;
    D square = 0.25 * (h * h * above / (z01 * z23));
    M fine = square <= spread(1.0);
    D factor = {0.9 * rough(square.a, -1.0 / 6), 0.9 * rough(square.b, -1.0 / 6)};
    factor = where(square < spread(1e300), factor, spread(0.1));
    factor = smaller(larger(factor, spread(0.1)), spread(10.0));
    factor = where(spread(0.5) < r(CAUTIOUS), smaller(factor, spread(1.0)), factor);
    factor = where(fine, factor, smaller(factor, spread(0.9)));
    D wanted = smaller(h * factor, r(LARGEST));
    D now = where(fine, where(last, spread(end), t + h), t);
    D tried = r(TRIED) + spread(1.0);
    store(g + 16 * T, now);
    store(g + 16 * H, wanted);
    store(g + 16 * CAUTIOUS, where(fine, spread(0.0), spread(1.0)));
    store(g + 16 * TRIED, tried);
    store(g + 16 * TAKEN, r(TAKEN) + where(fine, spread(1.0), spread(0.0)));
    store(g + 16 * X0, where(fine, x0, q0));
    store(g + 16 * X1, where(fine, x1, q1));
    store(g + 16 * Y0, where(fine, y0, v0));
    store(g + 16 * Y1, where(fine, y1, v1));
    store(g + 16 * B0, where(fine, d.x, a0));
    store(g + 16 * B1, where(fine, d.y, a1));
    M flagged = (now >= spread(end)) | (~fine & (wanted <= r(LEAST) + 4e-16 * t)) | (tried >= spread(most));
    flagged = flagged & (spread(0.5) < r(ALIVE));
    if (__builtin_expect(!any(flagged), 1)) return 0;
    unsigned which = bits(flagged);
    int idle = 0;
    for (int lane = 0; lane < 16; lane++) {
        if (!((which >> lane) & 1)) continue;
        double* row = out + int64_t(g[16 * JOB + lane]) * 7;
        row[0] = g[16 * T + lane];
        row[1] = g[16 * TAKEN + lane];
        row[2] = g[16 * TRIED + lane];
        for (int k = 0; k < 4; k++) row[3 + k] = g[16 * (X0 + k) + lane];
        refill(g, lane, table, next, total);
        idle += g[16 * ALIVE + lane] == 0.0;
    }
    return idle;
}

extern "C" int64_t given() { return GIVEN; }

extern "C" void run(const double* table, int64_t total, double end, double most, double* out) {
    alignas(64) static thread_local double groups[2][ROWS * 16];
    int64_t next = 0;
    int live[2] = {0, 0};
    for (int k = 0; k < 2; k++)
        for (int lane = 0; lane < 16; lane++) {
            refill(groups[k], lane, table, next, total);
            live[k] += groups[k][16 * ALIVE + lane] > 0.0;
        }
    while (live[0] > 0 || live[1] > 0)
        for (int k = 0; k < 2; k++)
            if (live[k] > 0) live[k] -= step(groups[k], end, most, table, next, total, out);
}

// Floating-point operations done by `turns` passes over twelve independent registers of fused products.
extern "C" double peak(int64_t turns, double seed) {
    Vec x[12];
    for (int k = 0; k < 12; k++) x[k] = all(seed + k);
    const Vec a = all(1.0 - 1e-9), b = all(1e-9);
    for (int64_t i = 0; i < turns; i++)
        for (int k = 0; k < 12; k++) x[k] = x[k] * a + b;
    Vec total = {};
    for (int k = 0; k < 12; k++) total += x[k];
    volatile double keep = total[0] + total[7];
    (void)keep;
    return double(turns) * 12 * 8 * 2;
}
