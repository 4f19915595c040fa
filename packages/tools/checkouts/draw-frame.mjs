/** Draws with the shaders that `frame` asks for, waiting for them. */
export async function drawFrame({ compiled }, view, frame) {
  view.render(frame);
  await view.whenDrawn();
  await compiled();
}

/** The frame as an image, without its background. */
export async function imageOfFrame(checkout, view, frame) {
  await drawFrame(checkout, view, frame);
  return lastImage(view);
}

/** What was drawn last. */
export async function lastImage(view) {
  const { widthPx, heightPx, data } = await view.readPixels();
  return { widthPx, heightPx, values: data };
}

/** Which effects are on, where and in which stages. Words and bytes are left out: they may change. */
export function effectsOf(view) {
  return view.effects().map(({ name, isOn, clouds, stages }) => ({ name, isOn, clouds, stages }));
}

/** Picks in a grid, so that some hit and some may miss. */
export async function picksOf(view, { widthPx, heightPx }) {
  const picks = [];
  for (const y of [0.3, 0.5, 0.8]) {
    for (const x of [0.05, 0.4, 0.55, 0.7]) {
      const pick = await view.pick(x * widthPx, y * heightPx);
      // The cloud itself cannot be written down; `cloudIndex` says which it is.
      picks.push(pick && { ...pick, cloud: pick.cloud.name, point: Array.from(pick.point) });
    }
  }
  return picks;
}

/** What an engine holds and has done: may differ, and is worth knowing. */
export function noteEngine(note, engine) {
  const { totalBytes, peakBytes } = engine.memory();
  note('memory', { totalBytes, peakBytes });
  note('counters', engine.counters());
}
