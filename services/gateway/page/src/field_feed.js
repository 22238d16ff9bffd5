// The field, which only some strategies have, what is sealed off from it, and its streamline. All are large, so that they are
// read while they are shown; the field also until one has come, which says that the present strategy has one.

export class FieldFeed {
  #isShown = false;
  #strategy; // undefined until something was said of it
  #last = null; // the last one, as long as it is that of the last decision
  #lastSealed = null; // what is sealed off from it

  /**
   * @param topics { field, sealed, streamline }
   * @param events { onField(message), onSealed(message), onStreamline(message), onForgotten(),
   * onKnown(whether there is one, name of the strategy) }
   */
  constructor(connection, topics, events) {
    Object.assign(this, { connection, topics, events });
    this.isThere = false;
  }

  /** Reads on, or no longer; what is at hand is shown at once, since the next decision may be long in coming. */
  show(on) {
    this.#isShown = on;
    if (on && this.#last) this.events.onField(this.#last);
    if (on && this.#last && this.#lastSealed) this.events.onSealed(this.#lastSealed);
    this.#listen();
  }

  /** The strategy by which the robot chooses now; null while none is known. What another one has computed is forgotten. */
  follow(strategy) {
    if (strategy === this.#strategy) return;
    this.#strategy = strategy;
    this.#last = this.#lastSealed = null;
    this.isThere = false;
    this.events.onForgotten();
    this.events.onKnown(false, strategy);
    this.#listen();
  }

  /** A decision was made at this time [s]. */
  decided(at) {
    if (this.#last && !this.#isShown && at > timeOf(this.#last)) this.#last = null;
  }

  #listen() {
    if (this.#isShown || !this.isThere) this.connection.subscribe(this.topics.field, (message) => this.#take(message));
    else this.connection.unsubscribe(this.topics.field);
    this.#listenWhileShown(this.topics.sealed, (message) => {
      this.#lastSealed = message;
      this.events.onSealed(message);
    });
    this.#listenWhileShown(this.topics.streamline, (message) => this.events.onStreamline(message));
  }
  #listenWhileShown(topic, handler) {
    if (this.#isShown) this.connection.subscribe(topic, handler);
    else this.connection.unsubscribe(topic);
  }
  #take(message) {
    this.#last = message;
    if (this.#isShown) this.events.onField(message);
    if (this.isThere) return;
    this.isThere = true;
    this.events.onKnown(true, this.#strategy);
    this.#listen();
  }
}

const timeOf = ({ header: { stamp } }) => stamp.sec + stamp.nanosec * 1e-9;
