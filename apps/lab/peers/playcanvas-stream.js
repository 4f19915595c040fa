import * as pc from 'playcanvas';
import { playCanvasScene } from './playcanvas-scene.js';

/** Numbers of `GSplatParams` that an address may set. */
const SETTINGS = ['splatBudget', 'lodUnderfillLimit'];

/**
 * PlayCanvas with streamed SOG.
 *
 * @type {import('../src/peers/adapter.ts').LoadPeer}
 */
export default async function loadPlayCanvas({ canvas, url, fileName, options }) {
  const { app, load, isReady, peer } = await playCanvasScene(pc, canvas);
  const given = SETTINGS.filter((name) => options.has(name));
  const settings = Object.fromEntries(given.map((name) => [name, Number(options.get(name))]));
  Object.assign(app.scene.gsplat, settings);
  await load(url, fileName);
  return { note: given.map((name) => `${name} ${settings[name]}`).join(', '), ...peer, isComplete: isReady };
}
