import { useStore } from 'zustand';
import { formatCount, formatSplats } from './format.ts';
import type { ViewerStore } from './store.ts';

export function SceneCaption({ store }: { store: ViewerStore }) {
  const scene = useStore(store, (state) => state.scene);
  if (!scene) return null;
  const { title, splats, shDegree, droppedSplats } = scene;
  return (
    <section className="panel caption" aria-label="Scene" data-testid="scene">
      <h1 data-testid="scene-title">{title}</h1>
      <p>
        {formatSplats(splats)} · SH {shDegree}
        {droppedSplats > 0 && ` · ${formatCount(droppedSplats)} unusable left out`}
      </p>
    </section>
  );
}
