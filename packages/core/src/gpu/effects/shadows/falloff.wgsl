/// Part of a lamp's light that is left at a distance; `end`: where it ends, 0: nowhere.
fn lightLeft(distance: f32, decay: f32, end: f32) -> f32 {
  let left = 1.0 / max(pow(max(distance, 1e-20), decay), 0.01);
  if (!(end > 0.0)) { return left; }
  let part = distance / end;
  let rest = clamp(1.0 - part * part * part * part, 0.0, 1.0);
  return left * rest * rest;
}
