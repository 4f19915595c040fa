import { useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import { READABLE_FORMATS } from '../file-drop/file-drop.ts';
import { GALLERY_ADDRESS } from '../hard-cases/case-addresses.ts';
import { benchmarkAddress } from '../links/lab-address.ts';
import type { ViewerStore } from '../state/store.ts';
import { IconButton } from '../ui/controls.tsx';
import { COMMANDS } from './commands.ts';

const GESTURES: readonly (readonly [string, string])[] = [
  ['Orbit', 'Left drag · one finger'],
  ['Pan', 'Right, middle or Shift drag · two fingers'],
  ['Zoom', 'Wheel, to the cursor · pinch'],
  ['Turn around a place', 'Double-click · double tap'],
  ['Inspect, measure (I)', 'Click · tap'],
  ['Select (I)', 'Drag · one finger'],
];

const CAMERA_KEYS: readonly (readonly [string, readonly string[]])[] = [
  ['Orbit', ['←', '→', '↑', '↓']],
  ['Pan', ['Shift', 'arrows']],
  ['Zoom', ['+', '−']],
  ['Walk', ['W', 'A', 'S', 'D']],
  ['Down, up', ['Page Down', 'Page Up']],
  ['Reset the view', ['Home']],
  ['A hard case’s cameras', ['[', ']']],
];

export function Help({ store }: { store: ViewerStore }) {
  const isVisible = useStore(store, (state) => state.isHelpVisible);
  const dialog = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    if (isVisible) dialog.current?.showModal();
    else dialog.current?.close();
  }, [isVisible]);
  const benchmark = benchmarkAddress(new URLSearchParams(location.search));
  const hide = () => store.setState({ isHelpVisible: false });
  return (
    <dialog
      ref={dialog}
      className="panel help"
      aria-labelledby="help-title"
      data-testid="help"
      onClose={hide}
      // The dialog's own padding is none, so that a click on the element itself is one beside it.
      onPointerDown={(event) => event.target === event.currentTarget && hide()}
    >
      <div className="help-body">
        <header className="spread">
          <h2 id="help-title">Keys and gestures</h2>
          <IconButton icon="close" label="Close" onClick={hide} />
        </header>
        <dl>
          {GESTURES.map(([what, how]) => (
            <div key={what}>
              <dt>{what}</dt>
              <dd>{how}</dd>
            </div>
          ))}
        </dl>
        <dl>
          {CAMERA_KEYS.map(([what, keys]) => (
            <div key={what}>
              <dt>{what}</dt>
              <dd>
                {keys.map((key) => (
                  <kbd key={key}>{key}</kbd>
                ))}
              </dd>
            </div>
          ))}
        </dl>
        <dl>
          {COMMANDS.map(({ name, label, key }) => (
            <div key={name}>
              <dt>{label}</dt>
              <dd>
                <kbd>{key.toUpperCase()}</kbd>
              </dd>
            </div>
          ))}
        </dl>
        <p>
          In flight (G) the mouse looks around, W, A, S, D, Q and E move, Shift is faster, the wheel changes
          the speed, and Escape ends it.
        </p>
        <p>
          On a gamepad the right stick turns, the left one moves, the triggers come nearer and go away; A
          frames the scene, B resets the view, and Y flies.
        </p>
        <p>
          Drop Gaussian-splat scenes ({READABLE_FORMATS}), or their folders, anywhere in the window: several
          at once are shown together, and with Shift they are added to what is shown. Captures often have y
          pointing down: U turns them.
        </p>
        <p>
          Scenes that break splat renderers: <a href={GALLERY_ADDRESS}>all hard cases</a>.
          {benchmark && (
            <>
              {' '}
              How fast this device draws, to be compared with others: <a href={benchmark}>benchmark</a>.
            </>
          )}
        </p>
      </div>
    </dialog>
  );
}
