import './open-panel.css';
import { TextButton } from '@websplatter/kit/controls';
import { formatSplats } from '@websplatter/kit/format';
import { builtinScenes } from '@websplatter/scenes';
import { type FormEvent, useEffect, useRef, useState } from 'react';
import type { KeptFile } from '../engine/keep/file-memory.ts';
import { galleryAddress } from '../engine/link/lab-address.ts';
import { READABLE_FORMATS } from '../engine/open/file-drop.ts';
import { addressIn, openAddress } from '../engine/open/open-address.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { Dock } from '../ui/dock.tsx';

/** What each built-in scene is good for, by its name. */
const ABOUT: Readonly<Record<string, string>> = {
  'still-life': 'Fruit, glass and plumes in evening light',
  'still-life-small': 'The same with few splats, for slow devices',
};

/** Files, addresses, samples and recent files to open. */
export function OpenPanel({
  store,
  viewer,
  onChoose,
  onReopen,
}: PanelProps & { onChoose: () => void; onReopen: (file: KeptFile) => void }) {
  const first = useRef<HTMLDivElement>(null);
  useEffect(() => first.current?.querySelector('button')?.focus(), []);
  const recent = useRecentFiles({ store, viewer });
  const gallery = galleryAddress();
  return (
    <Dock store={store} name="open">
      <div className="dock-body">
        <div ref={first} className="open-files">
          <TextButton look="primary" testId="choose-files" onClick={onChoose}>
            Choose files
          </TextButton>
          <p>{READABLE_FORMATS}. You can also drop them, or a link, anywhere.</p>
        </div>
        <AddressForm store={store} viewer={viewer} />
        <section>
          <h3>Sample scenes</h3>
          <ul className="open-list">
            {builtinScenes.map((scene) => (
              <li key={scene.name}>
                <button
                  type="button"
                  data-testid={`sample-${scene.name}`}
                  onClick={() => {
                    store.setState({ dock: null });
                    viewer.scenes.open({ kind: 'builtin', scene });
                  }}
                >
                  <b>{scene.title}</b>
                  <small>
                    {ABOUT[scene.name]} · {formatSplats(scene.splats)}
                  </small>
                </button>
              </li>
            ))}
            {gallery && (
              <li>
                <a href={gallery}>
                  <b>Hard cases</b>
                  <small>Small scenes that break splat renderers</small>
                </a>
              </li>
            )}
          </ul>
        </section>
        {recent.length > 0 && (
          <section data-testid="recent-files">
            <h3>Recent files</h3>
            <ul className="open-list">
              {recent.map((file) => (
                <li key={file.name}>
                  <button type="button" onClick={() => onReopen(file)}>
                    <b>{file.name}</b>
                  </button>
                </li>
              ))}
            </ul>
            <p>Only this browser remembers them.</p>
          </section>
        )}
      </div>
    </Dock>
  );
}

function AddressForm(panel: PanelProps) {
  const [isWrong, setWrong] = useState(false);
  const onSubmit = (event: FormEvent<HTMLFormElement>) => {
    event.preventDefault();
    const url = addressIn(String(new FormData(event.currentTarget).get('address')));
    setWrong(url === null);
    if (url) openAddress(panel, url);
  };
  return (
    <form className="open-address" onSubmit={onSubmit}>
      <label htmlFor="open-address">Address</label>
      <div>
        <input
          id="open-address"
          type="text"
          inputMode="url"
          name="address"
          required
          autoComplete="url"
          spellCheck={false}
          placeholder="https://example.com/scene.ply"
          aria-invalid={isWrong}
          aria-describedby="open-address-problem"
          data-testid="address"
        />
        <button type="submit" className="text-button outlined" data-testid="open-address">
          Open
        </button>
      </div>
      <p id="open-address-problem" role="status" className="open-problem">
        {isWrong && 'This is no address. It begins with https:// and ends with the name of a file.'}
      </p>
    </form>
  );
}

/** Files that this browser can open again. */
function useRecentFiles({ viewer }: PanelProps): readonly KeptFile[] {
  const [recent, setRecent] = useState<readonly KeptFile[]>([]);
  useEffect(() => {
    let isGone = false;
    void viewer.files.recent().then((files) => isGone || setRecent(files));
    return () => {
      isGone = true;
    };
  }, [viewer]);
  return recent;
}
