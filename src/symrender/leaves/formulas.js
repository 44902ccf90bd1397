// Emitted by targets/leaf_files.py from expression/formulas: change those, not this file.
const formulas = (() => {
"use strict";
const gleam = (base, exponent) => (base > 0.0 ? Math.pow(base, exponent) : exponent > 0.0 ? 0.0 : 1.0);

// N.l, the cosine before its cut at the terminator.
function lambert(to_light_x, to_light_y, to_light_z, normal_x, normal_y, normal_z) {
  const t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z;
  const t2 = Math.sqrt(Math.max(t1, 1e-300));
  return (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) / t2;
}

// (N.l, N.h) with h = (l + v)/|l + v|; N.h is 0 where l and v are opposite.
function blinn(to_light_x, to_light_y, to_light_z, normal_x, normal_y, normal_z, view_x, view_y, view_z) {
  const t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z;
  const t2 = Math.sqrt(Math.max(t1, 1e-300));
  const inverse = 1.0 / t2;
  const light_dir_x = to_light_x * inverse;
  const light_dir_y = to_light_y * inverse;
  const light_dir_z = to_light_z * inverse;
  const half_x = light_dir_x + view_x;
  const half_y = light_dir_y + view_y;
  const half_z = light_dir_z + view_z;
  const t3 = Math.sqrt(Math.max(half_x * half_x + half_y * half_y + half_z * half_z, 1e-300));
  return [light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z, (half_x * normal_x + half_y * normal_y + half_z * normal_z) / t3];
}

// (N.l, N.(l + v), (N.h)^2): the cosine's square needs no second root; its sign is that of the second.
function blinn_square(to_light_x, to_light_y, to_light_z, normal_x, normal_y, normal_z, view_x, view_y, view_z) {
  const t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z;
  const t2 = Math.sqrt(Math.max(t1, 1e-300));
  const inverse = 1.0 / t2;
  const light_dir_x = to_light_x * inverse;
  const light_dir_y = to_light_y * inverse;
  const light_dir_z = to_light_z * inverse;
  const half_x = light_dir_x + view_x;
  const half_y = light_dir_y + view_y;
  const half_z = light_dir_z + view_z;
  const t3 = normal_x * half_x + normal_y * half_y + normal_z * half_z;
  return [light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z, t3, t3 * t3 / Math.max(half_x * half_x + half_y * half_y + half_z * half_z, 1e-300)];
}

// (N.l, r.v) with r = 2 (N.l) N - l.
function phong(to_light_x, to_light_y, to_light_z, normal_x, normal_y, normal_z, view_x, view_y, view_z) {
  const t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z;
  const t2 = Math.sqrt(Math.max(t1, 1e-300));
  const inverse = 1.0 / t2;
  const cosine = (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) * inverse;
  const facing = normal_x * view_x + normal_y * view_y + normal_z * view_z;
  const toward = (to_light_x * view_x + to_light_y * view_y + to_light_z * view_z) * inverse;
  return [cosine, 2.0 * cosine * facing - toward];
}

// (N.l, s) with s = (N.h)^shininess, 0 where N.h is not positive.
function blinn_term(to_light_x, to_light_y, to_light_z, normal_x, normal_y, normal_z, view_x, view_y, view_z, shininess) {
  const t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z;
  const t2 = Math.sqrt(Math.max(t1, 1e-300));
  const inverse = 1.0 / t2;
  const light_dir_x = to_light_x * inverse;
  const light_dir_y = to_light_y * inverse;
  const light_dir_z = to_light_z * inverse;
  const half_x = light_dir_x + view_x;
  const half_y = light_dir_y + view_y;
  const half_z = light_dir_z + view_z;
  const t3 = Math.sqrt(Math.max(half_x * half_x + half_y * half_y + half_z * half_z, 1e-300));
  const base = (half_x * normal_x + half_y * normal_y + half_z * normal_z) / t3;
  return [light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z, gleam(base, shininess)];
}

// (N.l, s) with s = (r.v)^shininess, 0 where r.v is not positive.
function phong_term(to_light_x, to_light_y, to_light_z, normal_x, normal_y, normal_z, view_x, view_y, view_z, shininess) {
  const t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z;
  const t2 = Math.sqrt(Math.max(t1, 1e-300));
  const inverse = 1.0 / t2;
  const cosine = (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) * inverse;
  const facing = normal_x * view_x + normal_y * view_y + normal_z * view_z;
  const toward = (to_light_x * view_x + to_light_y * view_y + to_light_z * view_z) * inverse;
  const base = 2.0 * cosine * facing - toward;
  return [cosine, gleam(base, shininess)];
}

// One channel of one unblocked light: color (kd albedo N.l + ks s).
function light_channel(color, kd, ks, albedo, cosine, highlight) {
  return color * (kd * albedo * cosine + ks * highlight);
}

// m = D - 2 (D.N) N
function mirror_direction(incoming_x, incoming_y, incoming_z, normal_x, normal_y, normal_z) {
  const t1 = 2.0 * (incoming_x * normal_x + incoming_y * normal_y + incoming_z * normal_z);
  return [incoming_x - normal_x * t1, incoming_y - normal_y * t1, incoming_z - normal_z * t1];
}

// |w - m|^2 = 2 (1 - cos theta) of unit vectors.
function lobe_chord(direction_x, direction_y, direction_z, axis_x, axis_y, axis_z) {
  const t1 = direction_x - axis_x;
  const t2 = direction_y - axis_y;
  const t3 = direction_z - axis_z;
  return t1 * t1 + t2 * t2 + t3 * t3;
}

// log cos^n theta of depth = 1 - cos theta.
function log_power(depth, exponent) {
  return exponent * Math.log1p(-depth);
}

// cos^n theta / W at a direction whose squared distance from m is ``square``; 0 below the plane across m.
function lobe_density(square, exponent, log_normaliser) {
  const depth = 0.5 * square;
  if (!(depth < 1.0)) return 0.0;
  const log_cosine = Math.log1p(-depth);
  return Math.exp(exponent * log_cosine - log_normaliser);
}

// log cos theta_max; ``NO_RIM`` where the rim lies in the plane across the axis.
function log_rim(theta_max) {
  if (!(theta_max < 1.5707963267948966)) return -1e+300;
  const t1 = Math.sin(0.5 * theta_max);
  return Math.log1p(-2.0 * t1 * t1);
}

// 1 - cos^(n+1) theta, the share of the rimless lobe within theta, of log cos theta.
function lobe_mass(log_cosine, exponent) {
  return -Math.expm1((exponent + 1.0) * log_cosine);
}

// log W, by which a density is divided in its exponent.
function log_normaliser(log_cosine, exponent) {
  const u = exponent + 1.0;
  return Math.log(-(6.283185307179586 * Math.expm1(u * log_cosine) / u));
}

// Share of a ring: (cos^u low - cos^u high)/(1 - cos^u theta_max), u = n + 1, of logarithms of cosines.
function ring_share(log_low, log_high, log_cosine, exponent) {
  const u = exponent + 1.0;
  return Math.exp(u * log_low) * Math.expm1(u * (log_high - log_low)) / Math.expm1(u * log_cosine);
}

// (u, v) of a unit normal, both in [0, 1].
function texture_coordinates(normal_x, normal_y, normal_z) {
  return [(Math.atan2(normal_y, normal_x) + Math.PI) / 6.283185307179586, Math.acos(Math.max(-1.0, Math.min(1.0, normal_z))) / Math.PI];
}

// (u ku, v kv): whole numbers are the edges of a sphere's fields.
function texture_phases(normal_x, normal_y, normal_z, ku, kv) {
  const u = (Math.atan2(normal_y, normal_x) + Math.PI) / 6.283185307179586;
  const v = Math.acos(Math.max(-1.0, Math.min(1.0, normal_z))) / Math.PI;
  return [u * ku, v * kv];
}

// Albedo factor of the smooth veins, .55 + .225 (1 + sin(2 pi (ku u + .35 sin(3 pi kv v)))).
function vein(u, v, ku, kv) {
  const wave = Math.sin(6.283185307179586 * (ku * u + 0.35 * Math.sin(9.42477796076938 * kv * v)));
  return 0.55 + 0.225 * (1.0 + wave);
}

// Albedo factor of the veins at a unit normal.
function marble(normal_x, normal_y, normal_z, ku, kv) {
  const u = (Math.atan2(normal_y, normal_x) + Math.PI) / 6.283185307179586;
  const v = Math.acos(Math.max(-1.0, Math.min(1.0, normal_z))) / Math.PI;
  const wave = Math.sin(6.283185307179586 * (ku * u + 0.35 * Math.sin(9.42477796076938 * kv * v)));
  return 0.55 + 0.225 * (1.0 + wave);
}

// ((x - ox)/cell, (y - oy)/cell): squares of the floor, bright where their floors add up to an even number.
function floor_phases(x, y, cell, offset_x, offset_y) {
  return [(x - offset_x) / cell, (y - offset_y) / cell];
}

// One channel of a field of which ``share`` is bright.
function mixed(dark, bright, share) {
  return dark + share * (bright - dark);
}

// (hit point, unit normal) at inner coordinate ``x`` of the line (c, s) of a sphere's chart.
function sphere_point(x, c, s, pole_x, pole_y, pole_z, first_x, first_y, first_z, second_x, second_y, second_z, center_x, center_y, center_z, radius, ratio) {
  const across_x = first_x * c + second_x * s;
  const sine = Math.sin(x);
  const sb = ratio * sine;
  const cb = Math.sqrt(1.0 - sb * sb);
  const cosine = Math.cos(x);
  const sg = sine * cb - cosine * sb;
  const cg = cosine * cb + sine * sb;
  const facing_x = across_x * sg - pole_x * cg;
  const across_y = first_y * c + second_y * s;
  const facing_y = across_y * sg - pole_y * cg;
  const across_z = first_z * c + second_z * s;
  const facing_z = across_z * sg - pole_z * cg;
  return [center_x + facing_x * radius, center_y + facing_y * radius, center_z + facing_z * radius, facing_x, facing_y, facing_z];
}

// Hit point at inner coordinate ``x`` of the line (c, s) of the floor's chart; its z is 0.
function floor_point(x, c, s, first_x, first_y, first_z, second_x, second_y, second_z, point_x, point_y, point_z, height) {
  const across_x = first_x * c + second_x * s;
  const far = height * Math.tan(x);
  const across_y = first_y * c + second_y * s;
  return [point_x + across_x * far, point_y + across_y * far, 0.0];
}

// (distance, unit normal) where a ray meets a sphere from outside; ``offset`` = C - P, ``direction`` unit.
function sphere_hit(offset_x, offset_y, offset_z, direction_x, direction_y, direction_z, radius) {
  const along = offset_x * direction_x + offset_y * direction_y + offset_z * direction_z;
  const t1 = offset_y * direction_z - offset_z * direction_y;
  const t2 = offset_z * direction_x - offset_x * direction_z;
  const t3 = offset_x * direction_y - offset_y * direction_x;
  const square = radius * radius - (t1 * t1 + t2 * t2 + t3 * t3);
  const t4 = Math.sqrt(square);
  return [along - t4, -((offset_x - direction_x * along + direction_x * t4) / radius), -((offset_y - direction_y * along + direction_y * t4) / radius), -((offset_z - direction_z * along + direction_z * t4) / radius)];
}

// (distance, place) where a ray meets the floor.
function floor_hit(point_x, point_y, point_z, direction_x, direction_y, direction_z) {
  const t1 = point_z / direction_z;
  return [-t1, point_x - direction_x * t1, point_y - direction_y * t1, point_z - direction_z * t1];
}

// L + rho sqrt(u) (cos(2 pi v) e1 + sin(2 pi v) e2): uniform over the disk for uniform (u, v).
function disk_point(center_x, center_y, center_z, radius, first_x, first_y, first_z, second_x, second_y, second_z, u, v) {
  const angle = 6.283185307179586 * v;
  const t1 = Math.cos(angle);
  const t2 = Math.sin(angle);
  const t3 = radius * Math.sqrt(u);
  return [center_x + (first_x * t1 + second_x * t2) * t3, center_y + (first_y * t1 + second_y * t2) * t3, center_z + (first_z * t1 + second_z * t2) * t3];
}

return {lambert, blinn, blinn_square, phong, blinn_term, phong_term, light_channel, mirror_direction, lobe_chord, log_power, lobe_density, log_rim, lobe_mass, log_normaliser, ring_share, texture_coordinates, texture_phases, vein, marble, floor_phases, mixed, sphere_point, floor_point, sphere_hit, floor_hit, disk_point};
})();
