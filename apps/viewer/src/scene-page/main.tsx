// The page that the section “Web page” saves: the picture alone, of the scene in it or beside it.
import { followLinkedEffects } from '../links/linked-effects.ts';
import { linkedStart } from '../links/linked-start.ts';
import { keepStory } from '../navigation/keep-story.ts';
import type { SceneSource } from '../scene/scene-source.ts';
import { mirrorToDocument } from '../shell/document-mirror.ts';
import { show } from '../shell/show.tsx';
import { createViewerStore } from '../state/store.ts';
import { followViewMode } from '../view-modes/follow-view-mode.ts';
import { Viewer } from '../viewer/viewer.ts';
import { heldScene } from './held-scene.ts';
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
