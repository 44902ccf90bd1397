// Emitted by targets/leaf_files.py from expression/formulas: change those, not this file.
float own_sqrt(float x) { return sqrt(max(x, 0.0)); }

float own_sine(float x, float quarters) {
  // a whole number of quarter turns taken off in three parts; what is left lies in [-pi/4, pi/4]
  float k = floor(x*0.636619772 + 0.5);
  float r = ((x - k*1.5703125) - k*4.83751297e-4) - k*7.54978997e-8;
  float z = r*r;
  int turn = int(k + quarters) & 3;
  float s = ((-1.9515295891e-4*z + 8.3321608736e-3)*z - 1.6666654611e-1)*z*r + r;
  float c = ((2.443315711809948e-5*z - 1.388731625493765e-3)*z + 4.166664568298827e-2)*z*z - 0.5*z + 1.0;
  float value = (turn & 1) == 1 ? c : s;
  return turn > 1 ? -value : value;
}

float own_sin(float x) { return own_sine(x, 0.0); }

float own_cos(float x) { return own_sine(x, 1.0); }

float own_acos(float x) {
  float a = min(abs(x), 1.0);
  bool wide = a > 0.5;
  float z = wide ? 0.5*(1.0 - a) : a*a;
  float s = wide ? sqrt(z) : a;
  float p = (((4.2163199048e-2*z + 2.4181311049e-2)*z + 4.5470025998e-2)*z + 7.4953002686e-2)*z + 1.6666752422e-1;
  float t = p*z*s + s;
  float y = wide ? 2.0*t : 1.57079632679 - t;
  return x < 0.0 ? 3.14159265359 - y : y;
}

float own_atan2(float y, float x) {
  float a = abs(y), b = abs(x);
  float high = max(a, b), low = min(a, b);
  if (high == 0.0) { return 0.0; }
  float t = low/high;
  float base = 0.0;
  if (t > 0.414213562) { base = 0.785398163397; t = (low - high)/(low + high); }
  float z = t*t;
  float v = base + ((((8.05374449538e-2*z - 1.38776856032e-1)*z + 1.99777106478e-1)*z - 3.33329491539e-1)*z*t + t);
  v = a > b ? 1.57079632679 - v : v;
  v = x < 0.0 ? 3.14159265359 - v : v;
  return y < 0.0 ? -v : v;
}

float own_exp(float x) { return exp2(x*1.44269504); }

float own_series(float s) {
  // log((1 + s)/(1 - s))
  float z = s*s;
  return 2.0*s + 2.0*s*z*(0.33333333 + z*(0.2 + z*(0.14285714 + z*0.11111111)));
}

float own_log(float x) {
  if (x <= 0.0) { return -3.402823e38; }
  int bits = floatBitsToInt(x);
  int e = (bits >> 23) - 127;
  float m = intBitsToFloat((bits & 8388607) | 1065353216);
  if (m > 1.41421356) { m *= 0.5; e += 1; }
  return float(e)*0.693359375 + (own_series((m - 1.0)/(m + 1.0)) - float(e)*2.12194440e-4);
}

float own_log1p(float x) { return abs(x) < 0.25 ? own_series(x/(2.0 + x)) : 0.69314718*log2(1.0 + x); }

float own_expm1(float x) {
  if (abs(x) > 0.5) { return own_exp(x) - 1.0; }
  return x*(1.0 + x*(0.5 + x*(0.16666667 + x*(4.1666667e-2 + x*(8.3333333e-3 + x*(1.3888889e-3
    + x*(1.9841270e-4 + x*2.4801587e-5)))))));
}

float own_pow(float x, float y) { return y == 0.0 ? 1.0 : x <= 0.0 ? 0.0 : own_exp(y*own_log(x)); }

// N.l, the cosine before its cut at the terminator.
float lambert(float to_light_x, float to_light_y, float to_light_z, float normal_x, float normal_y, float normal_z) {
  float t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z;
  float t2 = own_sqrt(max(t1, 1.0e-37));
  return (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) / t2;
}

// (N.l, N.h) with h = (l + v)/|l + v|; N.h is 0 where l and v are opposite.
void blinn(float to_light_x, float to_light_y, float to_light_z, float normal_x, float normal_y, float normal_z, float view_x, float view_y, float view_z, out float out_cosine, out float out_base) {
  float t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z;
  float t2 = own_sqrt(max(t1, 1.0e-37));
  float inverse = 1.0 / t2;
  float light_dir_x = to_light_x * inverse;
  float light_dir_y = to_light_y * inverse;
  float light_dir_z = to_light_z * inverse;
  float half_x = light_dir_x + view_x;
  float half_y = light_dir_y + view_y;
  float half_z = light_dir_z + view_z;
  float t3 = own_sqrt(max(half_x * half_x + half_y * half_y + half_z * half_z, 1.0e-37));
  out_cosine = light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z;
  out_base = (half_x * normal_x + half_y * normal_y + half_z * normal_z) / t3;
}

// (N.l, N.(l + v), (N.h)^2): the cosine's square needs no second root; its sign is that of the second.
void blinn_square(float to_light_x, float to_light_y, float to_light_z, float normal_x, float normal_y, float normal_z, float view_x, float view_y, float view_z, out float out_cosine, out float out_lift, out float out_square) {
  float t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z;
  float t2 = own_sqrt(max(t1, 1.0e-37));
  float inverse = 1.0 / t2;
  float light_dir_x = to_light_x * inverse;
  float light_dir_y = to_light_y * inverse;
  float light_dir_z = to_light_z * inverse;
  float half_x = light_dir_x + view_x;
  float half_y = light_dir_y + view_y;
  float half_z = light_dir_z + view_z;
  float t3 = normal_x * half_x + normal_y * half_y + normal_z * half_z;
  out_cosine = light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z;
  out_lift = t3;
  out_square = t3 * t3 / max(half_x * half_x + half_y * half_y + half_z * half_z, 1.0e-37);
}

// (N.l, r.v) with r = 2 (N.l) N - l.
void phong(float to_light_x, float to_light_y, float to_light_z, float normal_x, float normal_y, float normal_z, float view_x, float view_y, float view_z, out float out_cosine, out float out_base) {
  float t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z;
  float t2 = own_sqrt(max(t1, 1.0e-37));
  float inverse = 1.0 / t2;
  float cosine = (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) * inverse;
  float facing = normal_x * view_x + normal_y * view_y + normal_z * view_z;
  float toward = (to_light_x * view_x + to_light_y * view_y + to_light_z * view_z) * inverse;
  out_cosine = cosine;
  out_base = 2.0 * cosine * facing - toward;
}

// (N.l, s) with s = (N.h)^shininess, 0 where N.h is not positive.
void blinn_term(float to_light_x, float to_light_y, float to_light_z, float normal_x, float normal_y, float normal_z, float view_x, float view_y, float view_z, float shininess, out float out_cosine, out float out_highlight) {
  float t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z;
  float t2 = own_sqrt(max(t1, 1.0e-37));
  float inverse = 1.0 / t2;
  float light_dir_x = to_light_x * inverse;
  float light_dir_y = to_light_y * inverse;
  float light_dir_z = to_light_z * inverse;
  float half_x = light_dir_x + view_x;
  float half_y = light_dir_y + view_y;
  float half_z = light_dir_z + view_z;
  float t3 = own_sqrt(max(half_x * half_x + half_y * half_y + half_z * half_z, 1.0e-37));
  float base = (half_x * normal_x + half_y * normal_y + half_z * normal_z) / t3;
  out_cosine = light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z;
  out_highlight = own_pow(base, shininess);
}

// (N.l, s) with s = (r.v)^shininess, 0 where r.v is not positive.
void phong_term(float to_light_x, float to_light_y, float to_light_z, float normal_x, float normal_y, float normal_z, float view_x, float view_y, float view_z, float shininess, out float out_cosine, out float out_highlight) {
  float t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z;
  float t2 = own_sqrt(max(t1, 1.0e-37));
  float inverse = 1.0 / t2;
  float cosine = (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) * inverse;
  float facing = normal_x * view_x + normal_y * view_y + normal_z * view_z;
  float toward = (to_light_x * view_x + to_light_y * view_y + to_light_z * view_z) * inverse;
  float base = 2.0 * cosine * facing - toward;
  out_cosine = cosine;
  out_highlight = own_pow(base, shininess);
}

// One channel of one unblocked light: color (kd albedo N.l + ks s).
float light_channel(float color, float kd, float ks, float albedo, float cosine, float highlight) {
  return color * (kd * albedo * cosine + ks * highlight);
}

// m = D - 2 (D.N) N
void mirror_direction(float incoming_x, float incoming_y, float incoming_z, float normal_x, float normal_y, float normal_z, out float out_axis_x, out float out_axis_y, out float out_axis_z) {
  float t1 = 2.0 * (incoming_x * normal_x + incoming_y * normal_y + incoming_z * normal_z);
  out_axis_x = incoming_x - normal_x * t1;
  out_axis_y = incoming_y - normal_y * t1;
  out_axis_z = incoming_z - normal_z * t1;
}

// |w - m|^2 = 2 (1 - cos theta) of unit vectors.
float lobe_chord(float direction_x, float direction_y, float direction_z, float axis_x, float axis_y, float axis_z) {
  float t1 = direction_x - axis_x;
  float t2 = direction_y - axis_y;
  float t3 = direction_z - axis_z;
  return t1 * t1 + t2 * t2 + t3 * t3;
}

// log cos^n theta of depth = 1 - cos theta.
float log_power(float depth, float exponent) {
  return exponent * own_log1p(-depth);
}

// cos^n theta / W at a direction whose squared distance from m is ``square``; 0 below the plane across m.
float lobe_density(float square, float exponent, float log_normaliser) {
  float depth = 0.5 * square;
  if (!(depth < 1.0)) return 0.0;
  float log_cosine = own_log1p(-depth);
  return own_exp(exponent * log_cosine - log_normaliser);
}

// log cos theta_max; ``NO_RIM`` where the rim lies in the plane across the axis.
float log_rim(float theta_max) {
  if (!(theta_max < 1.5707963267948966)) return -3.402823e38;
  float t1 = own_sin(0.5 * theta_max);
  return own_log1p(-2.0 * t1 * t1);
}

// 1 - cos^(n+1) theta, the share of the rimless lobe within theta, of log cos theta.
float lobe_mass(float log_cosine, float exponent) {
  return -own_expm1((exponent + 1.0) * log_cosine);
}

// log W, by which a density is divided in its exponent.
float log_normaliser(float log_cosine, float exponent) {
  float u = exponent + 1.0;
  return own_log(-(6.283185307179586 * own_expm1(u * log_cosine) / u));
}

// Share of a ring: (cos^u low - cos^u high)/(1 - cos^u theta_max), u = n + 1, of logarithms of cosines.
float ring_share(float log_low, float log_high, float log_cosine, float exponent) {
  float u = exponent + 1.0;
  return own_exp(u * log_low) * own_expm1(u * (log_high - log_low)) / own_expm1(u * log_cosine);
}

// (u, v) of a unit normal, both in [0, 1].
void texture_coordinates(float normal_x, float normal_y, float normal_z, out float out_u, out float out_v) {
  out_u = (own_atan2(normal_y, normal_x) + 3.14159265359) / 6.283185307179586;
  out_v = own_acos(normal_z) / 3.14159265359;
}

// (u ku, v kv): whole numbers are the edges of a sphere's fields.
void texture_phases(float normal_x, float normal_y, float normal_z, float ku, float kv, out float out_across, out float out_down) {
  float u = (own_atan2(normal_y, normal_x) + 3.14159265359) / 6.283185307179586;
  float v = own_acos(normal_z) / 3.14159265359;
  out_across = u * ku;
  out_down = v * kv;
}

// Albedo factor of the smooth veins, .55 + .225 (1 + sin(2 pi (ku u + .35 sin(3 pi kv v)))).
float vein(float u, float v, float ku, float kv) {
  float wave = own_sin(6.283185307179586 * (ku * u + 0.35 * own_sin(9.42477796076938 * kv * v)));
  return 0.55 + 0.225 * (1.0 + wave);
}

// Albedo factor of the veins at a unit normal.
float marble(float normal_x, float normal_y, float normal_z, float ku, float kv) {
  float u = (own_atan2(normal_y, normal_x) + 3.14159265359) / 6.283185307179586;
  float v = own_acos(normal_z) / 3.14159265359;
  float wave = own_sin(6.283185307179586 * (ku * u + 0.35 * own_sin(9.42477796076938 * kv * v)));
  return 0.55 + 0.225 * (1.0 + wave);
}

// ((x - ox)/cell, (y - oy)/cell): squares of the floor, bright where their floors add up to an even number.
void floor_phases(float x, float y, float cell, float offset_x, float offset_y, out float out_east, out float out_north) {
  out_east = (x - offset_x) / cell;
  out_north = (y - offset_y) / cell;
}

// One channel of a field of which ``share`` is bright.
float mixed(float dark, float bright, float share) {
  return dark + share * (bright - dark);
}

// (hit point, unit normal) at inner coordinate ``x`` of the line (c, s) of a sphere's chart.
void sphere_point(float x, float c, float s, float pole_x, float pole_y, float pole_z, float first_x, float first_y, float first_z, float second_x, float second_y, float second_z, float center_x, float center_y, float center_z, float radius, float ratio, out float out_place_x, out float out_place_y, out float out_place_z, out float out_normal_x, out float out_normal_y, out float out_normal_z) {
  float across_x = first_x * c + second_x * s;
  float sine = own_sin(x);
  float sb = ratio * sine;
  float cb = own_sqrt(1.0 - sb * sb);
  float cosine = own_cos(x);
  float sg = sine * cb - cosine * sb;
  float cg = cosine * cb + sine * sb;
  float facing_x = across_x * sg - pole_x * cg;
  float across_y = first_y * c + second_y * s;
  float facing_y = across_y * sg - pole_y * cg;
  float across_z = first_z * c + second_z * s;
  float facing_z = across_z * sg - pole_z * cg;
  out_place_x = center_x + facing_x * radius;
  out_place_y = center_y + facing_y * radius;
  out_place_z = center_z + facing_z * radius;
  out_normal_x = facing_x;
  out_normal_y = facing_y;
  out_normal_z = facing_z;
}

// Hit point at inner coordinate ``x`` of the line (c, s) of the floor's chart; its z is 0.
void floor_point(float x, float c, float s, float first_x, float first_y, float first_z, float second_x, float second_y, float second_z, float point_x, float point_y, float point_z, float height, out float out_place_x, out float out_place_y, out float out_place_z) {
  float across_x = first_x * c + second_x * s;
  float far = height * (own_sin(x)/own_cos(x));
  float across_y = first_y * c + second_y * s;
  out_place_x = point_x + across_x * far;
  out_place_y = point_y + across_y * far;
  out_place_z = 0.0;
}

// (distance, unit normal) where a ray meets a sphere from outside; ``offset`` = C - P, ``direction`` unit.
void sphere_hit(float offset_x, float offset_y, float offset_z, float direction_x, float direction_y, float direction_z, float radius, out float out_far, out float out_normal_x, out float out_normal_y, out float out_normal_z) {
  float along = offset_x * direction_x + offset_y * direction_y + offset_z * direction_z;
  float t1 = offset_y * direction_z - offset_z * direction_y;
  float t2 = offset_z * direction_x - offset_x * direction_z;
  float t3 = offset_x * direction_y - offset_y * direction_x;
  float square = radius * radius - (t1 * t1 + t2 * t2 + t3 * t3);
  float t4 = own_sqrt(square);
  out_far = along - t4;
  out_normal_x = -((offset_x - direction_x * along + direction_x * t4) / radius);
  out_normal_y = -((offset_y - direction_y * along + direction_y * t4) / radius);
  out_normal_z = -((offset_z - direction_z * along + direction_z * t4) / radius);
}

// (distance, place) where a ray meets the floor.
void floor_hit(float point_x, float point_y, float point_z, float direction_x, float direction_y, float direction_z, out float out_far, out float out_place_x, out float out_place_y, out float out_place_z) {
  float t1 = point_z / direction_z;
  out_far = -t1;
  out_place_x = point_x - direction_x * t1;
  out_place_y = point_y - direction_y * t1;
  out_place_z = point_z - direction_z * t1;
}

// L + rho sqrt(u) (cos(2 pi v) e1 + sin(2 pi v) e2): uniform over the disk for uniform (u, v).
void disk_point(float center_x, float center_y, float center_z, float radius, float first_x, float first_y, float first_z, float second_x, float second_y, float second_z, float u, float v, out float out_place_x, out float out_place_y, out float out_place_z) {
  float angle = 6.283185307179586 * v;
  float t1 = own_cos(angle);
  float t2 = own_sin(angle);
  float t3 = radius * own_sqrt(u);
  out_place_x = center_x + (first_x * t1 + second_x * t2) * t3;
  out_place_y = center_y + (first_y * t1 + second_y * t2) * t3;
  out_place_z = center_z + (first_z * t1 + second_z * t2) * t3;
}
