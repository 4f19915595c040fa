import type { ReactNode } from 'react';
import { IconButton } from '../ui/controls.tsx';
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
      <IconButton icon="close" label={`Dismiss the ${kind}`} testId={`dismiss-${kind}`} onClick={onDismiss} />
    </section>
  );
}
