import type { AccuracySettings, AccuracyWish } from '@websplatter/core';
import type { LinkedCamera } from '../camera/view-camera.ts';
import { hardCaseNameIn, hardCaseScene } from '../hard-cases/catalogue.ts';
import { ADDRESS_NAMES, addressedScene } from '../scene/first-source.ts';
import type { SceneSource } from '../scene/scene-source.ts';
import type { EffectChoices } from '../state/effect-choices.ts';
import type { ViewModeName } from '../state/view-mode.ts';
import { encodeAccuracy } from '../words/accuracy-address.ts';
import { encodeCamera } from './camera-text.ts';
import { encodeComparison, type LinkedComparison } from './comparison-text.ts';
import { encodeEffects } from './effects-text.ts';
import { encodeViewMode } from './view-mode-text.ts';

/** What an address tells of the viewer. */
export interface LinkedView {
  /** Null before there is a scene. */
  readonly source: SceneSource | null;
  readonly camera: LinkedCamera;
  readonly accuracy: AccuracySettings | AccuracyWish;
  readonly comparison: LinkedComparison | null;
  readonly effects: EffectChoices;
  readonly viewMode: ViewModeName;
}

/** What this device and this window begin with, which the address of the page need not mention. */
export interface UnmentionedView {
  /** The first view of the scene. */
  readonly camera: LinkedCamera | null;
  readonly accuracy: AccuracySettings;
}

/** Names in the query of what belongs to the scene that it was chosen for, at that scene's scale. */
const OF_ONE_SCENE = ['camera', 'effects'];

/** `page` as it is to be while `view` is shown: path, query and fragment. What it says besides stays. */
export function pageAddress(page: URL, view: LinkedView, unmentioned: UnmentionedView): string {
  const query = new URLSearchParams(page.search);
  const camera = encodeCamera(view.camera);
  const isFirstView = unmentioned.camera !== null && camera === encodeCamera(unmentioned.camera);
  if (isFallback(view.source, query)) for (const name of OF_ONE_SCENE) query.delete(name);
  else {
    // Nobody else has a file of this device: its camera and effects would be those of another scene.
    const isShared = view.source !== null && view.source.kind !== 'file';
    const isMentioned = isShared && !isFirstView;
    const effects = isShared ? encodeEffects(view.effects) : null;
    write(query, 'camera', isMentioned ? camera : null);
    write(query, 'effects', effects);
    writeSource(query, view.source, page, isMentioned || effects !== null);
  }
  write(query, 'accuracy', encodeAccuracy(view.accuracy, unmentioned.accuracy));
  write(query, 'compare', view.comparison && encodeComparison(view.comparison));
  write(query, 'mode', encodeViewMode(view.viewMode));
  return addressWith(page, query);
}

/**
 * A whole address that shows the same picture on any device, in a window of the same size; null where the scene is a file
 * of this one.
 */
export function linkTo(page: URL, view: LinkedView): string | null {
  if (view.source === null || view.source.kind === 'file') return null;
  const query = new URLSearchParams(page.search);
  writeSource(query, view.source, page, true);
  write(query, 'camera', encodeCamera(view.camera));
  write(query, 'effects', encodeEffects(view.effects));
  write(query, 'accuracy', encodeAccuracy(view.accuracy, null));
  write(query, 'compare', view.comparison && encodeComparison(view.comparison));
  write(query, 'mode', encodeViewMode(view.viewMode));
  return page.origin + addressWith(page, query);
}

/** Whether a built-in scene is shown in place of what the address names, which could not be opened. */
export function isFallback(source: SceneSource | null, query: URLSearchParams): boolean {
  const { addresses = [], scene } = addressedScene(query);
  return source?.kind === 'builtin' && (addresses.length > 0 || hardCaseNameIn(scene) !== null);
}

/** @param isNamed whether a built-in scene is named even where the query names none. */
function writeSource(query: URLSearchParams, source: SceneSource | null, page: URL, isNamed: boolean): void {
  if (source === null) return;
  const urls = urlsOf(source);
  const named = (addressedScene(query).addresses ?? []).map((each) =>
    URL.canParse(each, page) ? new URL(each, page).href : each,
  );
  // Addresses stay as they were written: they may be relative to the page.
  const areNamed = urls.length > 0 && urls.join('\n') === named.join('\n');
  if (!areNamed) {
    for (const name of ADDRESS_NAMES) query.delete(name);
    for (const url of urls) query.append('src', url);
  }
  const scene = sceneName(source);
  if (scene === null) query.delete('scene');
  else if (isNamed || source.kind !== 'builtin' || query.has('scene')) query.set('scene', scene);
}

function urlsOf(source: SceneSource): readonly string[] {
  if (source.kind === 'url') return [source.url.href];
  return source.kind === 'urls' ? source.urls.map(({ href }) => href) : [];
}

/** As `?scene=` names it; null where it is not by a name that it is found. */
function sceneName(source: SceneSource): string | null {
  if (source.kind === 'builtin') return source.scene.name;
  return source.kind === 'hard-case' ? hardCaseScene(source.name) : null;
}

function write(query: URLSearchParams, name: string, text: string | null): void {
  if (text === null) query.delete(name);
  else query.set(name, text);
}

function addressWith(page: URL, query: URLSearchParams): string {
  // A query may hold these unescaped, which is easier to read.
  const text = query
    .toString()
    .replaceAll('%2C', ',')
    .replaceAll('%3A', ':')
    .replaceAll('%2F', '/')
    .replace(/=(?=&|$)/g, '');
  return `${page.pathname}${text && `?${text}`}${page.hash}`;
}
