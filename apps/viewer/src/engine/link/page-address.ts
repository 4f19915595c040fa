import type { AccuracySettings, AccuracyTarget, Detail } from '@websplatter/core';
import { encodeAccuracy } from '../../state/accuracy-address.ts';
import type { Annotation } from '../../state/annotating.ts';
import type { Background } from '../../state/camera.ts';
import type { Crop } from '../../state/inspecting.ts';
import { LINK_FIELDS, type LinkedComparison } from '../../state/link-fields.ts';
import { FIRST_PATH, type LinkedCamera, type PathSettings, type SavedView } from '../../state/saved-view.ts';
import { SCENE_LINK_FIELDS } from '../../state/scene-link-fields.ts';
import type { ViewerState } from '../../state/store.ts';
import type { ViewModeName } from '../../state/view-mode.ts';
import type { SceneSource } from '../open/scene-source.ts';
import { ownUp, type ShownPart } from '../open/shown-scene.ts';
import type { Viewer } from '../viewer.ts';
import { ADDRESS_NAMES, addressedScene } from './addressed-scene.ts';
import { hardCaseNameIn, hardCaseScene } from './case-addresses.ts';
import { PLACE_NAME } from './linked-start.ts';
import { PLACE_FIELD } from './place-link.ts';

/** The viewer's state in a URL. */
export interface LinkedView {
  /** Sources of the scene's files; empty before there is a scene. */
  readonly sources: readonly SceneSource[];
  /** Look of each file, by `PLACE_FIELD`; empty if all are drawn as saved. */
  readonly looks: readonly string[];
  readonly camera: LinkedCamera;
  readonly accuracy: AccuracySettings | AccuracyTarget;
  /** Null unless the user or the URL chose one. */
  readonly detail: Detail | null;
  readonly comparison: LinkedComparison | null;
  /** As `EFFECTS_FIELD` writes them; null if there are none. */
  readonly effects: string | null;
  readonly crop: Crop | null;
  readonly viewMode: ViewModeName;
  readonly background: Background;
  readonly savedViews: readonly SavedView[];
  readonly path: PathSettings;
  readonly annotations: readonly Annotation[];
}

/** State at start on this device and window, which the page's URL need not mention. */
export interface UnmentionedView {
  /** The first view of the scene. */
  readonly camera: LinkedCamera | null;
  readonly accuracy: AccuracySettings;
}

const { camera: CAMERA, compare: COMPARE, mode: MODE, detail: DETAIL, background: BACKGROUND } = LINK_FIELDS;
const { crop: CROP, view: VIEW, path: PATH, annotation: ANNOTATION } = SCENE_LINK_FIELDS;

/** Query parameters that fit only the scene for which they were written, at its scale. */
const OF_ONE_SCENE = [CAMERA.name, 'effects', CROP.name, VIEW.name, PATH.name, ANNOTATION.name];

/** URL of `page` for `view`: path, query and fragment. Unrelated parameters are kept. */
export function pageAddress(page: URL, view: LinkedView, unmentioned: UnmentionedView): string {
  const query = new URLSearchParams(page.search);
  const camera = CAMERA.encode(view.camera);
  const isFirstView = unmentioned.camera !== null && camera === CAMERA.encode(unmentioned.camera);
  if (isFallback(view.sources, query)) for (const name of OF_ONE_SCENE) query.delete(name);
  else {
    // Local files are missing on other devices: camera, effects and crop would apply to another
    // scene.
    const isShared = canLink(view.sources);
    write(query, CAMERA.name, isShared && !isFirstView ? camera : null);
    write(query, 'effects', isShared ? view.effects : null);
    write(query, CROP.name, isShared && view.crop ? CROP.encode(view.crop) : null);
    writeStory(query, isShared ? view : NO_STORY);
    const isNamed = OF_ONE_SCENE.some((name) => query.has(name));
    writeSources(query, view, page, isNamed);
  }
  writeDrawing(query, view, unmentioned.accuracy);
  return addressWith(page, query);
}

/** URL of `page` without files and their looks, and without all that fits only the scene if no file is left. */
export function addressWithout(page: URL, sources: readonly SceneSource[]): string {
  const query = new URLSearchParams(page.search);
  const gone = new Set(sources.map((source) => (source.kind === 'url' ? source.url.href : null)));
  const files = ADDRESS_NAMES.flatMap((name) => query.getAll(name).map((text) => ({ name, text })));
  const isLeft = files.map(({ text }) => text !== '' && !gone.has(URL.parse(text, page)?.href ?? null));
  const looks = query.getAll(PLACE_NAME);
  for (const name of [...ADDRESS_NAMES, PLACE_NAME]) query.delete(name);
  if (!isLeft.includes(true)) for (const name of ['scene', ...OF_ONE_SCENE]) query.delete(name);
  for (const [i, { name, text }] of files.entries()) if (isLeft[i]) query.append(name, text);
  for (const [i, look] of looks.entries()) if (isLeft[i]) query.append(PLACE_NAME, look);
  return addressWith(page, query);
}

/**
 * Absolute URL that shows the same picture on any device in a window of the same size. Null if
 * `canLink` is false.
 */
export function linkTo(page: URL, view: LinkedView): string | null {
  if (!canLink(view.sources)) return null;
  const query = new URLSearchParams(page.search);
  writeSources(query, view, page, true);
  writeView(query, view);
  return page.origin + addressWith(page, query);
}

/** Query that restores a view in a page that embeds its scene. */
export function heldView(view: LinkedView): string {
  const query = new URLSearchParams();
  for (const look of view.looks) query.append(PLACE_NAME, look);
  writeView(query, view);
  return query.toString();
}

/** Writes everything except the files and their looks. */
function writeView(query: URLSearchParams, view: Omit<LinkedView, 'sources' | 'looks'>): void {
  write(query, CAMERA.name, CAMERA.encode(view.camera));
  write(query, 'effects', view.effects);
  write(query, CROP.name, view.crop && CROP.encode(view.crop));
  writeDrawing(query, view, null);
  writeStory(query, view);
}

/** Writes how any scene is drawn. @param unmentioned as for `encodeAccuracy`. */
function writeDrawing(
  query: URLSearchParams,
  { accuracy, detail, comparison, viewMode, background }: Omit<LinkedView, 'sources' | 'looks'>,
  unmentioned: AccuracySettings | null,
): void {
  write(query, 'accuracy', encodeAccuracy(accuracy, unmentioned));
  write(query, DETAIL.name, detail && DETAIL.encode(detail));
  write(query, COMPARE.name, comparison && COMPARE.encode(comparison));
  write(query, MODE.name, MODE.encode(viewMode));
  write(query, BACKGROUND.name, BACKGROUND.encode(background));
}

type Story = Pick<LinkedView, 'savedViews' | 'path' | 'annotations'>;
const NO_STORY: Story = { savedViews: [], path: FIRST_PATH, annotations: [] };

function writeStory(query: URLSearchParams, { savedViews, path, annotations }: Story): void {
  query.delete(VIEW.name);
  for (const view of savedViews) query.append(VIEW.name, VIEW.encode(view));
  write(query, PATH.name, PATH.encode(path));
  query.delete(ANNOTATION.name);
  for (const annotation of annotations) query.append(ANNOTATION.name, ANNOTATION.encode(annotation));
}

/** Whether a built-in scene is shown because the URL's scene could not be opened. */
export function isFallback(sources: readonly SceneSource[], query: URLSearchParams): boolean {
  const { addresses = [], scene } = addressedScene(query);
  return (
    sources.length === 1 &&
    sources[0].kind === 'builtin' &&
    (addresses.length > 0 || hardCaseNameIn(scene) !== null)
  );
}

/** Whether a URL can name the scene: files on servers, or one scene that has a name. */
export function canLink(sources: readonly SceneSource[]): boolean {
  const areOnServers = sources.every(({ kind }) => kind === 'url');
  return sources.length > 0 && (areOnServers || (sources.length === 1 && sources[0].kind !== 'file'));
}

/** @param isNamed whether a built-in scene is written even if the query names none. */
function writeSources(
  query: URLSearchParams,
  { sources, looks }: Pick<LinkedView, 'sources' | 'looks'>,
  page: URL,
  isNamed: boolean,
): void {
  if (sources.length === 0) return;
  const isLinkable = canLink(sources);
  const urls = isLinkable
    ? sources.flatMap((source) => (source.kind === 'url' ? [source.url.href] : []))
    : [];
  // File URLs are written unchanged: they may be relative to the page.
  const written = addressedScene(query).addresses ?? [];
  const textOf = new Map(written.toReversed().map((text) => [URL.parse(text, page)?.href, text]));
  const texts = urls.map((url) => textOf.get(url) ?? url);
  if (texts.join('\n') !== written.join('\n')) {
    for (const name of ADDRESS_NAMES) query.delete(name);
    for (const text of texts) query.append('src', text);
  }
  query.delete(PLACE_NAME);
  if (isLinkable) for (const look of looks) query.append(PLACE_NAME, look);
  const scene = isLinkable ? sceneName(sources[0]) : null;
  if (scene === null) query.delete('scene');
  else if (isNamed || looks.length > 0 || sources[0].kind !== 'builtin' || query.has('scene'))
    query.set('scene', scene);
}

/** Value of `?scene=`; null if the source is not opened by a name. */
function sceneName(source: SceneSource): string | null {
  if (source.kind === 'builtin') return source.scene.name;
  return source.kind === 'hard-case' ? hardCaseScene(source.name) : null;
}

function write(query: URLSearchParams, name: string, text: string | null): void {
  if (text === null) query.delete(name);
  else query.set(name, text);
}

function addressWith(page: URL, query: URLSearchParams): string {
  // Queries may contain these characters unescaped, which is easier to read.
  const text = query
    .toString()
    .replaceAll('%2C', ',')
    .replaceAll('%3A', ':')
    .replaceAll('%2F', '/')
    .replace(/=(?=&|$)/g, '');
  return `${page.pathname}${text && `?${text}`}${page.hash}`;
}

/** Contents of an address that shows the present view again. */
export function linkedViewOf(viewer: Viewer, state: ViewerState): LinkedView {
  const { target, accuracy, comparison, splitPart, requested, inspecting } = state;
  const parts = viewer.scenes.newest?.parts ?? [];
  return {
    sources: parts.map(({ source }) => source),
    looks: looksOf(parts),
    camera: viewer.camera.snapshot(),
    accuracy: target ?? accuracy,
    detail: state.isDetailChosen ? state.detail : null,
    comparison: comparison && { comparison, splitPart },
    effects: requested.text,
    crop: inspecting.crop,
    viewMode: state.viewMode,
    background: state.look.background,
    savedViews: state.savedViews,
    path: state.path,
    annotations: state.annotating.list,
  };
}

/** None where all files are drawn as they come when they are opened together. */
function looksOf(parts: readonly ShownPart[]): readonly string[] {
  const looks = parts.map(({ look }) => PLACE_FIELD.encode(look));
  // Files that have another way up than the first are turned by themselves.
  const areAllAlike = new Set(parts.map(({ loaded }) => ownUp(loaded))).size < 2;
  return areAllAlike && looks.every((look) => look === '') ? [] : looks;
}
