"""What is Chipmunk's and pymunk's own and not public: structs in memory, and private names."""
