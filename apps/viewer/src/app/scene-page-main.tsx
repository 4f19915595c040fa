// The page that the section “Web page” saves: the picture alone, of the scene in it or beside it.
import { followLinkedEffects } from '../effects/linked-effects.ts';
import { linkedStart } from '../engine/linked-start.ts';
import type { SceneSource } from '../engine/scene-source.ts';
import { Viewer } from '../engine/viewer.ts';
import { keepStory } from '../navigate/keep-story.ts';
import { createViewerStore } from '../state/store.ts';
import { followViewMode } from '../view-modes/follow-view-mode.ts';
import { mirrorToDocument } from './document-mirror.ts';
import { heldScene } from './held-scene.ts';
import { show } from './show.tsx';
import './scene-page.css';
import { ScenePage } from './scene-page.tsx';

const { title, view, poster, sources } = heldScene(document);
const query = new URLSearchParams(view);
const store = createViewerStore();
store.setState({ hasInterface: false });
mirrorToDocument(store, document, () => title);
const viewer = new Viewer(store, {
  held: sources,
  accuracy: query.get('accuracy'),
  linked: linkedStart(query),
});
viewer.prepare();
followViewMode(store, viewer);
const isHeld = (shown: readonly SceneSource[]) => shown.every((source) => sources.includes(source));
followLinkedEffects({ store, viewer }, query, isHeld);
keepStory({ store, viewer }, query, null, isHeld);
show(<ScenePage store={store} viewer={viewer} poster={poster} />);
