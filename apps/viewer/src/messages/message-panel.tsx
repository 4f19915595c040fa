import type { ReactNode } from 'react';
import { Icon } from '../ui/icon.tsx';

/** A message that stays until it is dismissed. */
export function MessagePanel(props: {
  kind: 'error' | 'warning';
  title: string;
  children: ReactNode;
  onDismiss: () => void;
}) {
  const { kind, title, children, onDismiss } = props;
  return (
    <section className={`panel message ${kind}`} data-testid={kind}>
      <Icon name="warning" />
      <div className="message-text">
        <h2>{title}</h2>
        {children}
      </div>
      <button
        type="button"
        className="icon-button"
        aria-label={`Dismiss the ${kind}`}
        data-testid={`dismiss-${kind}`}
        onClick={onDismiss}
      >
        <Icon name="close" />
      </button>
    </section>
  );
}
