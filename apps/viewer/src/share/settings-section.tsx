import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { pathThrough } from '../navigate/view-path.ts';
import { upAxisOf } from '../state/up-axis.ts';
import { TextButton } from '../ui/controls.tsx';
import { formatBytes } from '../ui/format.ts';
import { download } from './download.ts';
import { settingsOfView } from './settings-of-view.ts';
import { writeSceneSettings } from './write-settings.ts';

const FILE_NAME = 'settings.json';
const LIST = new Intl.ListFormat('en');

/** Saves how the scene is shown for SuperSplat's viewer. */
export function SettingsSection({ store, viewer }: PanelProps) {
  const hasPicture = useStore(store, (state) => state.imageId > 0);
  const isAnnotated = useStore(store, (state) => state.annotating.list.length > 0);
  const hasPath = useStore(store, (state) => pathThrough(state.savedViews).length > 1);
  const axis = useStore(store, upAxisOf);
  const isUpsideDown = useStore(store, (state) => state.scene?.isUpsideDown ?? false);
  const parts = [
    'This view',
    'the background',
    ...(hasPath ? ['the path'] : []),
    ...(isAnnotated ? ['the annotations'] : []),
  ];
  const fileUp = isUpsideDown ? '-y' : 'y';
  return (
    <section>
      <h3>Settings for SuperSplat’s viewer</h3>
      <p data-testid="settings-about">
        {LIST.format(parts)}, as a settings.json beside the scene. This viewer opens it, too.
        {axis !== fileUp && ` SuperSplat’s viewer shows ${fileUp.replace('-', '−')} upwards.`}
      </p>
      <TextButton disabled={!hasPicture} testId="save-settings" onClick={() => save({ store, viewer })}>
        Save {FILE_NAME}
      </TextButton>
    </section>
  );
}

function save({ store, viewer }: PanelProps): void {
  const background = viewer.shownFrame?.frame.background;
  if (!background) return;
  const { savedViews, annotating, scene, widthPx, heightPx } = store.getState();
  const isUpsideDown = scene?.isUpsideDown ?? false;
  const [red, green, blue] = background;
  const text = writeSceneSettings(
    settingsOfView(viewer.camera.snapshot(), savedViews, annotating.list, {
      isUpsideDown,
      aspect: widthPx / heightPx,
      background: [red, green, blue],
    }),
  );
  const file = new Blob([text], { type: 'application/json' });
  download(file, FILE_NAME);
  store.setState({ notice: `Saved ${FILE_NAME} (${formatBytes(file.size)}).` });
}
