"""What pymunk calls in each step: the resolver of contacts, the handlers that call it, and events."""
